// Meshes, bodies and random states that the tests of sim/ share, and finite differences.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "common/rng.h"
#include "sim/elastic/models.h"
#include "sim/rest/rest_space.h"
#include "sim/solve/forward_step.h"
#include "sim/world.h"

namespace vivify::sim {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

// A lattice of cells, each cut into five tetrahedra in alternating orientation, from `corner` to corner +
// size. The lattice is point symmetric about every inner vertex.
TetMesh box_mesh(const Eigen::Vector3i& cells, const Eigen::Vector3d& size, const Eigen::Vector3d& corner);

// A small mesh of every kind that a model may live on, about half a metre large and nowhere regular; more
// than one where the topology matters.
struct NamedMesh {
  std::string name;
  SimMesh mesh;
};
std::vector<NamedMesh> small_meshes(int dimension, int element_points);
// Smooth deformations of a mesh, each turned as a whole: two in group "a" and one in group "b".
std::vector<ExamplePose> smooth_poses(const SimMesh& mesh);
// Coordinates of the points in a box with 4 or 8 corners around them: the harmonic coordinates of a
// box-shaped cage.
Matrix multilinear_weights(const RowMatrixXd& V);

// Every vertex, as a point of one of its elements with a single weight; of tetrahedra those of the boundary.
ContactPoints vertex_contacts(const SimMesh& mesh);
// Points inside every element, `count` of each, with weights that are all different.
ContactPoints inner_contacts(const SimMesh& mesh, int count, std::uint64_t seed);
ContactPoints join(const ContactPoints& a, const ContactPoints& b);

// Settings given as YAML, checked and completed.
Value settings(const Schema& schema, const std::string& yaml);

struct Scene {
  std::string model = "{}", regularizer = "{}", contact = "{}", controller = "{}", solver = "{}";
};
BodyInput box_input(const TetMesh& mesh, const Scene& scene = {});

// A model on a mesh with a rest space, which need not be in the registries.
struct BodyCase {
  ModelEntry model;
  RestSpaceEntry space;
  NamedMesh mesh;
};
inline void PrintTo(const BodyCase& tested, std::ostream* out) {
  *out << tested.model.name << " on a " << tested.mesh.name << " with " << tested.space.name;
}
// Every model with every rest space on each of its small meshes.
std::vector<BodyCase> body_cases(std::span<const ModelEntry> models, std::span<const RestSpaceEntry> spaces);
std::string case_name(const ::testing::TestParamInfo<BodyCase>& tested);
// Input with cage weights, poses and contact points. `scene.model` are settings besides the type: "damping_s:
// 0.1".
BodyInput body_input(const BodyCase& body, const Scene& scene = {.model = ""});
// The box of the benchmarks: 120 vertices, 1 m high, standing on y = 0.
TetMesh standing_box();
// A small one of 27 vertices, 0.5 m high.
TetMesh small_box();

// A square of 100 m through `point`.
Collider plane(double friction, const Eigen::Vector3d& normal = Eigen::Vector3d::UnitY(),
               const Eigen::Vector3d& point = Eigen::Vector3d::Zero());
std::vector<Collider> one(Collider collider);

// Puts the only body of a world into a state of motion, as a restart would.
void set_motion(World& world, const Vector& x, const Vector& v);

Vector flat(const RowMatrixXd& V);
Points rows(const Vector& x);  // of bodies in space
Vector random_vector(Eigen::Index size, double scale, CounterRng& rng);
Eigen::Matrix3d random_rotation(CounterRng& rng);
// R x_i + b for every point.
Vector rigid(const Eigen::Matrix3d& R, const Eigen::Vector3d& b, const Vector& x);
// The same in as many dimensions as R has.
Matrix random_rotation(int dimension, CounterRng& rng);
Vector moved(const Matrix& R, const Vector& b, const Vector& x);
Matrix dense(const SymmetricMatrix& matrix);

using Function = std::function<Vector(const Vector&)>;
// Central differences, one column per coordinate of x.
Matrix differences(const Function& f, const Vector& x, double eps);
// |a − b| over |b|.
double relative(const Matrix& a, const Matrix& b);
// Error of the central difference along `d` with step 2 eps, over the error with step eps: 4 when the
// derivative is right and truncation dominates.
double convergence(const Function& f, const Vector& x, const Vector& d, const Vector& exact, double eps);
// Whether that is 4, or the differences are exact to rounding already, as those of low polynomials.
::testing::AssertionResult converges(const Function& f, const Vector& x, const Vector& d, const Vector& exact,
                                     double eps);

// One step of a twisted and squeezed little body with goals for centre and spin, pressed against a tilted
// plane so that some contact points stick, some slip, some have just arrived and some are above the contact
// layer.
struct RandomStep {
  RandomStep(const BodyCase& tested, const Scene& scene, std::uint64_t seed, double friction, double noise);
  // A solid box with a cage.
  RandomStep(std::uint64_t seed, double friction, double noise = 0.02);
  RandomStep(const RandomStep&) = delete;

  BodyModel body;
  std::vector<Collider> colliders;
  ContactSet contacts, no_contacts;
  Goals goals;
  Vector x, q;
  std::unique_ptr<StepProblem> problem, in_air;  // with and without the contacts
  std::unique_ptr<StepWorkspace> workspace;
  int sticking = 0, slipping = 0, pressing = 0, above = 0;
  double room = 1;  // m: no contact changes its regime within this distance
};

}  // namespace vivify::sim
