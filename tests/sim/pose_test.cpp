#include "sim/pose.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "common/error.h"
#include "sim/control/rigid_motion.h"
#include "sim/rest/registration.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

using testing::HasSubstr;

constexpr double kTurn = 2 * std::numbers::pi;
const Eigen::Vector3d kBarSize = {0.2, 1, 0.2};

SimMesh bar(int along = 10) { return sim_mesh(box_mesh({2, along, 2}, kBarSize, {-0.1, 0, -0.1})); }
Value model(const std::string& yaml) { return settings(model_schema(), yaml); }

PoseHandle region(const std::string& name, const Eigen::Vector3d& min, const Eigen::Vector3d& max) {
  PoseHandle handle;
  handle.region = {name, min, max};
  return handle;
}
PoseHandle bottom() { return region("bottom", {0, 0, 0}, {1, 0, 1}); }
PoseHandle top() { return region("top", {0, 1, 0}, {1, 1, 1}); }

// Kind and text of what a pose throws.
Error failure(const SimMesh& mesh, const std::vector<PoseHandle>& handles, const std::string& yaml = "{}") {
  try {
    solve_pose(mesh, model(yaml), handles);
  } catch (const Error& error) {
    return error;
  }
  return {ErrorKind::internal, "nothing was thrown"};
}

TEST(Pose, HandlesThatMoveTogetherMoveTheBodyRigidly) {
  const SimMesh mesh = bar();
  for (const std::string type : {"{type: solid3d}", "{type: solid3d_stvk}"}) {
    PoseHandle turned = top();
    turned.angle = 0.45 * kTurn;
    turned.axis = {1, 2, -2};
    turned.move = {0.3, -0.2, 0.7};
    const PoseSolution pose = solve_pose(mesh, model(type), std::vector{turned});
    const Eigen::Vector3d about(0, 1, 0);
    const Eigen::AngleAxisd R(turned.angle, turned.axis.normalized());
    for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
      const Eigen::Vector3d wanted = about + R * (mesh.V.row(i).transpose() - about) + turned.move;
      EXPECT_LE((pose.V.row(i).transpose() - wanted).norm(), 1e-6) << type;
    }
    EXPECT_EQ(pose.held, std::vector{9});
  }
}

// Patch test: when every vertex of the boundary follows an affine map, those inside do too.
TEST(Pose, AffineBoundaryGivesAnAffinePose) {
  const SimMesh mesh = sim_mesh(box_mesh({4, 4, 4}, {1, 1, 1}, {0, 0, 0}));
  PoseHandle skin;
  skin.region.handle = "skin";
  for (int i = 0; i < mesh.V.rows(); ++i) {
    if ((mesh.V.row(i).array() == 0).any() || (mesh.V.row(i).array() == 1).any())
      skin.region.vertices.push_back(i);
  }
  skin.scale = {1.2, 0.8, 1.1};
  skin.about = {0, 0.5, 1};
  for (const std::string type : {"{type: solid3d}", "{type: solid3d_stvk}"}) {
    const PoseSolution pose = solve_pose(mesh, model(type), std::vector{skin});
    const Eigen::RowVector3d about(0, 0.5, 1);
    for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
      const Eigen::RowVector3d wanted = about + (mesh.V.row(i) - about).cwiseProduct(skin.scale.transpose());
      EXPECT_LE((pose.V.row(i) - wanted).norm(), 1e-7) << type;
    }
    EXPECT_NEAR(pose.smallest_element, std::min(1.0, skin.scale.prod()), 1e-7);
  }
}

class TwistTest : public testing::TestWithParam<std::tuple<std::string, double>> {};

TEST_P(TwistTest, TurnsTheMiddleByHalf) {
  const auto& [type, turns] = GetParam();
  const SimMesh mesh = bar(10);
  PoseHandle turned = top();
  turned.angle = turns * kTurn;
  const PoseSolution pose = solve_pose(mesh, model(type), std::vector{bottom(), turned});
  EXPECT_GT(pose.smallest_element, 0.2);
  EXPECT_GE(pose.increments, std::round(36 * turns));
  // The outer vertices of the middle, on average: the lattice is not symmetric under the turn.
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
    if (std::abs(mesh.V(i, 1) - 0.5) > 1e-9 || mesh.V.row(i).cwiseAbs().minCoeff() == 0) continue;
    EXPECT_NEAR(pose.V(i, 1), 0.5, 0.02);
    const Eigen::Rotation2Dd half(-0.5 * turned.angle);  // a turn about +y takes z to x
    const Eigen::Vector2d back = half.inverse() * Eigen::Vector2d(pose.V(i, 0), pose.V(i, 2));
    mean += Eigen::Vector2d(back[0] * mesh.V(i, 0) + back[1] * mesh.V(i, 2),
                            back[1] * mesh.V(i, 0) - back[0] * mesh.V(i, 2));
  }
  EXPECT_LE(std::abs(std::atan2(mean[1], mean[0])), 0.02 * turned.angle);
  // An example can be made of it.
  const ElasticModel elastic = build_model(mesh, RestLayout::incompatible, model(type));
  EXPECT_NO_THROW(register_elements(stack(pose.V, elastic.rest), stack(mesh.V, elastic.rest), elastic.rest, 3,
                                    "twisted"));
}

INSTANTIATE_TEST_SUITE_P(Solids, TwistTest,
                         testing::Combine(testing::Values("{type: solid3d}", "{type: solid3d_stvk}"),
                                          testing::Values(0.5, 1.0)));

// A rod on a wall sags under its own weight by w L⁴ / 8 EI (Euler and Bernoulli).
TEST(Pose, SagsAsACantilever) {
  SimMesh rod;
  const int n = 40;
  rod.V = RowMatrixXd::Zero(n + 1, 2);
  rod.E.resize(n, 2);
  for (int i = 0; i <= n; ++i) rod.V(i, 0) = static_cast<double>(i) / n;
  for (int i = 0; i < n; ++i) rod.E.row(i) << i, i + 1;
  PoseHandle wall;
  wall.region.handle = "wall";
  wall.region.vertices = {0, 1};
  const PoseSolution pose =
      solve_pose(rod, model("{type: rod2d, density: 1, stiffness: 10000, bending_stiffness: 100}"),
                 std::vector{wall}, {0, -10, 0});
  const double free = 1 - 1.0 / n / 2;  // the clamp reaches to the middle of its edge
  EXPECT_NEAR(-pose.V(n, 1), 10 * std::pow(free, 4) / 8 / 100, 0.01 * 10.0 / 8 / 100);
  EXPECT_EQ(pose.V(0, 1), 0);
}

TEST(Pose, BendsAFlatSolid) {
  SimMesh sheet;  // 0.25 by 1 m, two triangles per cell
  const int nx = 4, ny = 16;
  sheet.V.resize((nx + 1) * (ny + 1), 2);
  sheet.E.resize(2 * nx * ny, 3);
  for (int j = 0, e = 0; j <= ny; ++j) {
    for (int i = 0; i <= nx; ++i) {
      const int v = i + (nx + 1) * j;
      sheet.V.row(v) << 0.25 * i / nx, 1.0 * j / ny;
      if (i == nx || j == ny) continue;
      sheet.E.row(e++) << v, v + 1, v + nx + 2;
      sheet.E.row(e++) << v, v + nx + 2, v + nx + 1;
    }
  }
  PoseHandle turned = top();
  turned.angle = kTurn / 4;
  turned.move = {-0.5, -0.2, 0};
  for (const std::string type : {"{type: solid2d}", "{type: solid2d_printed}"}) {
    const PoseSolution pose = solve_pose(sheet, model(type), std::vector{bottom(), turned});
    EXPECT_GT(pose.smallest_element, 0.3) << type;
    // The upper edge stands upright now: it was turned by a quarter about its middle.
    const Eigen::RowVector2d edge = pose.V.row(sheet.V.rows() - 1) - pose.V.row(sheet.V.rows() - 1 - nx);
    EXPECT_LE((edge - Eigen::RowVector2d(0, 0.25)).norm(), 1e-12) << type;
  }
}

// A strip whose ends are turned apart by a quarter, free to come nearer: an arc, whose middle leans by half
// of it.
TEST(Pose, BendsAShell) {
  SimMesh strip;
  const int nx = 4, ny = 32;
  strip.V.resize((nx + 1) * (ny + 1), 3);
  strip.E.resize(2 * nx * ny, 3);
  for (int j = 0, e = 0; j <= ny; ++j) {
    for (int i = 0; i <= nx; ++i) {
      const int v = i + (nx + 1) * j;
      strip.V.row(v) << 0.125 * i / nx, 1.0 * j / ny, 0;
      if (i == nx || j == ny) continue;
      if ((i + j) % 2 == 0) {
        strip.E.row(e++) << v, v + 1, v + nx + 2;
        strip.E.row(e++) << v, v + nx + 2, v + nx + 1;
      } else {
        strip.E.row(e++) << v, v + 1, v + nx + 1;
        strip.E.row(e++) << v + 1, v + nx + 2, v + nx + 1;
      }
    }
  }
  const double end = 1.0 / ny, angle = kTurn / 4, arc = 1 - 2 * end, radius = arc / angle;
  PoseHandle lower = region("lower", {0, 0, 0}, {1, end, 1}),
             upper = region("upper", {0, 1 - end, 0}, {1, 1, 1});
  upper.angle = angle;
  upper.axis = {1, 0, 0};
  upper.about = {0, 1 - end, 0};
  upper.move = {0, radius * std::sin(angle) - arc, radius * (1 - std::cos(angle))};
  const PoseSolution pose = solve_pose(
      strip, model("{type: shell3d, stiffness: 10000, bending_stiffness: 0.01}"), std::vector{lower, upper});
  EXPECT_LE(pose.iterations, 40 * pose.increments);
  double worst = 0;
  for (Eigen::Index v = 0; v < strip.V.rows(); ++v) {
    const double s = strip.V(v, 1) - end, turned = std::clamp(s / radius, 0.0, angle);
    if (s < 0 || s > arc) continue;
    const Eigen::RowVector3d wanted(strip.V(v, 0), end + radius * std::sin(turned),
                                    radius * (1 - std::cos(turned)));
    worst = std::max(worst, (pose.V.row(v) - wanted).norm());
  }
  EXPECT_LE(worst, 0.01);
}

TEST(Pose, SaysWhatIsWrongWithHandles) {
  const SimMesh mesh = bar();
  const Error nothing = failure(mesh, {bottom(), region("handles[1]", {2, 2, 2}, {3, 3, 3})});
  EXPECT_EQ(nothing.kind(), ErrorKind::usage);
  EXPECT_THAT(nothing.what(), HasSubstr("handles[1] takes hold of no vertex"));
  const Error twice = failure(mesh, {bottom(), region("handles[1]", {0, 0, 0}, {0, 1, 0})});
  EXPECT_EQ(twice.kind(), ErrorKind::usage);
  EXPECT_THAT(twice.what(), HasSubstr("bottom and handles[1] both take hold of vertex 0"));
  PoseHandle still = top();
  still.angle = 1;
  still.axis.setZero();
  EXPECT_THAT(failure(mesh, {still}).what(), HasSubstr("axis without length"));
  PoseHandle flat = top();
  flat.scale = {1, 0, 1};
  EXPECT_THAT(failure(mesh, {flat}).what(), HasSubstr("scale"));
  PoseHandle other = top();
  other.region.vertices = {99};
  EXPECT_THAT(failure(mesh, {other}).what(), HasSubstr("vertex 99"));
  PoseHandle endless = top();
  endless.angle = 1e5;
  EXPECT_THAT(failure(mesh, {bottom(), endless}).what(), HasSubstr("top goes too far"));
  EXPECT_EQ(failure(mesh, {}).kind(), ErrorKind::usage);
  EXPECT_EQ(failure(mesh, {bottom()}, "{type: shell3d}").kind(), ErrorKind::geometry);
}

TEST(Pose, SaysHowFarItCame) {
  PoseHandle pushed = top();
  pushed.move = {0, -2, 0};  // through the floor that the bottom is pinned to
  PoseHandle sides = region("sides", {0, 0.05, 0}, {0, 0.95, 1});
  const Error error = failure(bar(), {bottom(), pushed, sides});
  EXPECT_EQ(error.kind(), ErrorKind::numerical);
  EXPECT_THAT(error.what(), HasSubstr("% of their way"));
}

// Violent handles: the pose is found, or the solver says that it was not; never a number that is none, never
// a hang.
TEST(Pose, SurvivesViolentHandles) {
  int found = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    CounterRng rng(seed);
    const auto random = [&](double from, double to) {
      return Eigen::Vector3d(rng.uniform(from, to), rng.uniform(from, to), rng.uniform(from, to));
    };
    const SimMesh mesh = sim_mesh(box_mesh({1, 4, 1}, {0.3, 1, 0.3}, {0, 0, 0}));
    PoseHandle wild = top();
    wild.region.min.y() = rng.uniform(0.6, 1);
    wild.angle = rng.uniform(-0.6, 0.6) * kTurn;
    wild.axis = random(-1, 1);
    wild.move = random(-0.5, 0.5);
    wild.scale = random(0.6, 1.8);
    const double stiffness = std::pow(10, rng.uniform(3, 7));
    const std::string material = "{type: " + std::string(seed % 2 == 0 ? "solid3d" : "solid3d_stvk") +
                                 ", stiffness: " + std::to_string(stiffness) +
                                 ", volume_stiffness: " + std::to_string(stiffness) + "}";
    try {
      const PoseSolution pose = solve_pose(mesh, model(material), std::vector{bottom(), wild}, {0, -9.81, 0});
      EXPECT_TRUE(pose.V.allFinite()) << seed;
      EXPECT_GT(pose.smallest_element, 0) << seed;
      ++found;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::numerical) << seed << " " << error.what();
    }
  }
  EXPECT_GE(found, 3);
}

TEST(Pose, IsTheSameEveryTime) {
  PoseHandle turned = top();
  turned.angle = 1;
  const SimMesh mesh = bar();
  const auto pose = [&] { return solve_pose(mesh, model("{}"), std::vector{bottom(), turned}).V; };
  EXPECT_EQ(pose(), pose());
}

}  // namespace
}  // namespace vivify::sim
