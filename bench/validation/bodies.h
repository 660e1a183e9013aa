// Bodies of the validation problems, their equilibria and their vibrations.
#pragma once

#include <memory>

#include "common/rng.h"
#include "sim/body.h"
#include "sim/solve/forward_step.h"
#include "sim/solve/static_solve.h"

namespace vivify::validation {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

// Settings given as YAML, checked and completed. Throws the first Error.
Value settings(const Schema& schema, const std::string& yaml);

// What make_body_model needs besides the mesh and the model (YAML); without contact and controller.
sim::BodyInput body_input(const SimMesh& mesh, const std::string& model,
                          const std::string& rest_space = "full");
sim::BodyModel body(const SimMesh& mesh, const std::string& model);

// A small body of every model: a curved chain, a block or a curved strip with rough elements, about 1 m long.
// `keys` are further keys of the model, ", damping_s: 0.01".
struct Sample {
  std::string model;  // name
  SimMesh mesh;
  std::string yaml;  // of the model
};
std::vector<Sample> samples(const std::string& keys = "");

// The sample with a rest space: `cage` is its bounding box with multilinear weights, `examples` and `strains`
// have two bent poses.
sim::BodyModel sample_body(const Sample& sample, const std::string& rest_space);
// A pose of the mesh, bent along x by `curvature` (1/m) and sheared a little.
RowMatrixXd bent_pose(const SimMesh& mesh, double curvature);

// Independent uniform numbers in [−reach, reach).
Vector random_vector(Eigen::Index size, double reach, CounterRng& rng);

// A step of a sample in a random state, pressed out of shape, without contact, with three goals for random sums
// of coordinates (its centre of mass cannot be controlled in the air).
struct StepState {
  StepState(const Sample& sample, const std::string& rest_space, std::uint64_t seed);
  StepState(const StepState&) = delete;

  sim::BodyModel body;
  sim::ContactSet contacts;
  sim::Goals goals;
  Vector x, q;
  std::unique_ptr<sim::StepProblem> problem;
};

// Elastic energy, its gradient, and its Hessian at x for the rest measures S.
double energy(const sim::BodyModel& body, const std::vector<Vector>& S, const Vector& x);
Vector gradient(const sim::BodyModel& body, const std::vector<Vector>& S, const Vector& x);
void stiffness(const sim::BodyModel& body, const std::vector<Vector>& S, const Vector& x,
               sim::SymmetricMatrix& D);
// The rows and columns of held vertices replaced by those of the identity times `diagonal`.
void hold(const std::vector<bool>& held, int dimension, double diagonal, sim::SymmetricMatrix& D);

// Equilibrium with the body's own rest shape from x under constant forces, solved until no force exceeds
// `tolerance` times the sum of all applied, or what rounding leaves. Throws Error(numerical) when it is not
// reached.
Vector equilibrium(const sim::BodyModel& body, const Vector& x, const Vector& force,
                   const std::vector<bool>& held, double tolerance = 1e-9);

// Lowest angular frequency (rad/s) of the body at rest with held vertices, by inverse iteration.
double lowest_frequency(const sim::BodyModel& body, const std::vector<bool>& held);

// Free flight and vibration: implicit Euler without contact and goals, each step exact to rounding.
class Motion {
 public:
  // Refers to `body`; starts at x with velocity v.
  Motion(const sim::BodyModel& body, Vector x, Vector v, double h, double gravity = 0);
  // One step to the rest shape q. Throws Error(numerical) when it cannot be solved.
  void step(const Vector& q);
  const Vector& x() const { return x_; }
  const Vector& v() const { return v_; }
  const Vector& internal_forces() const { return forces_; }  // of the last step, N
  double kinetic_energy() const;

 private:
  const sim::BodyModel& body_;
  sim::StepWorkspace workspace_;
  Vector x_, v_, forces_;
  double h_, gravity_;
};

// The masses of the coordinates, d #V.
Vector coordinate_masses(const sim::BodyModel& body);

// Resultant of forces about the origin: its torque has one component in the plane, three in space.
struct Resultant {
  Vector force, torque;
};
Resultant resultant(const Vector& x, const Vector& forces, int dimension);

}  // namespace vivify::validation
