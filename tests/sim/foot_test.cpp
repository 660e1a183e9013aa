// The goals of a foot: reached exactly by a body that is where its target says.
#include "sim/control/foot.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "bench/bodies.h"
#include "sim/control/rigid_motion.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

constexpr double kTurn = 0.4;
const Eigen::Vector3d kShift(0.3, 0.05, -0.2);

// Vertices of the mesh in y = 0 with x < 0.3.
std::vector<int> sole(const RowMatrixXd& V) {
  std::vector<int> vertices;
  for (int i = 0; i < V.rows(); ++i) {
    if (V(i, 1) < 1e-9 && V(i, 0) < V.col(0).minCoeff() + 0.3) vertices.push_back(i);
  }
  return vertices;
}

TEST(Foot, InSpaceEveryVertexOfItsSoleHasItsPlace) {
  const SimMesh mesh = bench::cells(4, 4, 2, 0.25, [](int, int, int) { return true; });
  const Vector mass = Vector::Ones(mesh.V.rows()), rest = flat(mesh.V);
  const Foot foot({mass, rest, 1, 9.81, 0.01}, sole(mesh.V));
  const Eigen::Matrix3d R = Eigen::AngleAxisd(kTurn, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const Vector x = flat((mesh.V * R.transpose()).rowwise() + kShift.transpose());
  std::vector<Goal> goals;
  foot.add_goals(x, {.at = foot.centre(x), .rate = {0.1, 0.2, 0.3}, .yaw = kTurn}, 2, 3, goals);
  ASSERT_EQ(goals.size(), 3 * foot.vertices().size());
  double kp = 0, kd = 0;
  for (const Goal& goal : goals) {
    EXPECT_NEAR(goal.a.dot(x), goal.sx, 1e-12);
    kp += goal.kp * goal.kp / 3;
    kd += goal.kd * goal.kd / 3;
  }
  EXPECT_NEAR(kp, 2 * 2, 1e-12) << "of the foot as a whole";
  EXPECT_NEAR(kd, 3 * 3, 1e-12);
  EXPECT_NEAR(foot.centre(x).y(), foot.standing_height(x, kShift.y()), 1e-12);
  EXPECT_NEAR(foot.home().x(), foot.centre(rest).x() - centre_of_mass(mass, rest).x(), 1e-12);
}

TEST(Foot, InThePlaneItsCentreHasAGoalAndItTurnsUpright) {
  const SimMesh mesh = bench::letter({"####", "####", "#..#", "#..#"}, 1, 0.25);
  const Vector mass = Vector::LinSpaced(mesh.V.rows(), 1, 2), rest = flat(mesh.V);
  const Foot foot({mass, rest, 1, 9.81, 0.01}, sole(mesh.V));
  const Eigen::Matrix2d R = Eigen::Rotation2Dd(kTurn).toRotationMatrix();
  const Vector x = flat((mesh.V * R.transpose()).rowwise() + kShift.head<2>().transpose());
  std::vector<Goal> goals;
  foot.add_goals(x, {.at = foot.centre(x), .rate = {0.1, 0.2, 0}, .upright = 5}, 2, 3, goals);
  ASSERT_EQ(goals.size(), 3u);
  for (int axis = 0; axis < 2; ++axis) {
    EXPECT_NEAR(goals[axis].a.dot(x), goals[axis].sx, 1e-12);
    EXPECT_EQ(goals[axis].kp, 2);
    EXPECT_EQ(goals[axis].kd, 3);
  }
  EXPECT_EQ(goals[2].kp, 0);
  EXPECT_NEAR(goals[2].sv, -5 * std::sin(kTurn), 0.1) << "back";
}

}  // namespace
}  // namespace vivify::sim
