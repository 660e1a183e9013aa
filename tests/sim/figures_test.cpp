// Figures 4 and 5 of Coros et al. 2012 on regular meshes: the incompatible interpolation of Section 5 beside
// interpolation in strain space, both reconstructed by the static solve.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "sim/control/rigid_motion.h"
#include "sim/pose.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

constexpr int kWeights = 10;
constexpr double kTurn = 2 * std::numbers::pi;

// A body whose shape at every weight is the equilibrium of its interpolated rest shape.
class Interpolation {
 public:
  Interpolation(const SimMesh& mesh, const RowMatrixXd& example, const std::string& space,
                const std::string& model)
      : world_({input(mesh, example, space, model)}, {}, {Eigen::Vector3d::Zero(), 1.0 / kWeights, true}) {}

  void step() { world_.step(); }
  const Body& body() const { return world_.body(0); }

  // Largest relative error of an edge against the length interpolated between the poses.
  double edge_error(const SimMesh& mesh, const RowMatrixXd& example) const {
    const double p = body().p()[0];
    double largest = 0;
    for (Eigen::Index t = 0; t < mesh.E.rows(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const int a = mesh.E(t, k), b = mesh.E(t, (k + 1) % 3);
        const double wanted =
            (1 - p) * (mesh.V.row(a) - mesh.V.row(b)).norm() + p * (example.row(a) - example.row(b)).norm();
        const double length = (body().x().segment<3>(3 * a) - body().x().segment<3>(3 * b)).norm();
        largest = std::max(largest, std::abs(length / wanted - 1));
      }
    }
    return largest;
  }

 private:
  static BodyInput input(const SimMesh& mesh, const RowMatrixXd& example, const std::string& space,
                         const std::string& model) {
    BodyInput input =
        box_input(small_box(), {.model = model,
                                .controller = "{type: blend, keys: [{t: 0, weights: [0]}, {t: 1, "
                                              "weights: [1]}]}"});
    input.rest = mesh;
    input.rest_space = space;
    input.contact_points = {};
    input.examples = {{"example", "", example}};
    return input;
  }
  World world_;
};

// Largest distance of a vertex of a and b after rigid alignment (m).
double distance(const Vector& mass, const Vector& a, const Vector& b) {
  const Eigen::Matrix3d R = best_rotation(mass, a, b);
  const Vector moved = rigid(R, centre_of_mass(mass, b) - R * centre_of_mass(mass, a), a);
  double largest = 0;
  for (Eigen::Index i = 0; i < mass.size(); ++i) {
    largest = std::max(largest, (moved.segment<3>(3 * i) - b.segment<3>(3 * i)).norm());
  }
  return largest;
}

// Figure 4: measured 0.0049 for three quarters of a turn.
TEST(Figures, TwistedBarIsThatOfGreenStrainProjection) {
  const SimMesh mesh = sim_mesh(box_mesh({2, 10, 2}, {0.2, 1, 0.2}, {-0.1, 0, -0.1}));
  PoseHandle bottom, top;
  bottom.region = {"bottom", {0, 0, 0}, {1, 0, 1}};
  top.region = {"top", {0, 1, 0}, {1, 1, 1}};
  top.angle = 0.75 * kTurn;
  const RowMatrixXd twisted = solve_pose(mesh, settings(model_schema(), "{}"), std::vector{bottom, top}).V;
  for (const std::string model : {"{type: solid3d}", "{type: solid3d_stvk}"}) {
    Interpolation ours(mesh, twisted, "examples", model),
        reference(mesh, twisted, "strains", "{type: solid3d_stvk}");
    double largest = 0;
    for (int i = 0; i < kWeights; ++i) {
      ours.step();
      reference.step();
      const double d = distance(ours.body().model().mass, ours.body().x(), reference.body().x());
      EXPECT_LE(d, 0.01) << "weight " << ours.body().p();
      largest = std::max(largest, d);
    }
    EXPECT_GT(largest, 1e-4) << "the methods are not the same";
  }
}

// A tube of length 1, and the tube bent round a helix without twisting it: two turns that climb by 30
// degrees.
struct Tube {
  Tube(int around, int along, double radius) {
    const double rho = 1 / (2 * kTurn), a = rho * std::cos(kTurn / 12), b = rho * std::sin(kTurn / 12);
    mesh.V.resize(around * (along + 1), 3);
    helix.resize(mesh.V.rows(), 3);
    mesh.E.resize(2 * around * along, 3);
    for (int j = 0, t = 0; j <= along; ++j) {
      const double s = static_cast<double>(j) / along, phi = s / rho;
      const Eigen::Vector3d centre(a * std::cos(phi), b * phi, a * std::sin(phi)),
          tangent = Eigen::Vector3d(-a * std::sin(phi), b, a * std::cos(phi)) / rho,
          normal(-std::cos(phi), 0, -std::sin(phi));
      const double torsion = b / (rho * rho);
      const Eigen::Vector3d u = Eigen::AngleAxisd(-torsion * s, tangent) * normal, v = u.cross(tangent);
      for (int i = 0; i < around; ++i) {
        const int here = i + around * j, next = (i + 1) % around + around * j;
        const double angle = kTurn * i / around;
        mesh.V.row(here) << radius * std::cos(angle), s, radius * std::sin(angle);
        helix.row(here) = (centre + radius * (std::cos(angle) * u + std::sin(angle) * v)).transpose();
        if (j == along) continue;
        if ((i + j) % 2 == 0) {
          mesh.E.row(t++) << here, here + around, next;
          mesh.E.row(t++) << next, here + around, next + around;
        } else {
          mesh.E.row(t++) << here, here + around, next + around;
          mesh.E.row(t++) << here, next + around, next;
        }
      }
    }
  }
  SimMesh mesh;
  RowMatrixXd helix;
};

// Figure 5: measured 0.0022 of the length, edges within 0.006.
TEST(Figures, HelixIsThatOfLengthsAndAngles) {
  const Tube tube(12, 80, 0.03);
  const std::string model = "{type: shell3d, stiffness: 10000, bending_stiffness: 0.02}";
  Interpolation ours(tube.mesh, tube.helix, "examples", model),
      reference(tube.mesh, tube.helix, "strains", model);
  double largest = 0;
  for (int i = 0; i < kWeights; ++i) {
    ours.step();
    reference.step();
    const double d = distance(ours.body().model().mass, ours.body().x(), reference.body().x());
    EXPECT_LE(d, 0.05) << "weight " << ours.body().p();
    EXPECT_LE(ours.edge_error(tube.mesh, tube.helix), 0.01);
    EXPECT_LE(reference.edge_error(tube.mesh, tube.helix), 0.01);
    largest = std::max(largest, d);
  }
  EXPECT_GT(largest, 1e-4) << "the methods are not the same";
}

}  // namespace
}  // namespace vivify::sim
