// Rest shapes by keyframes, in motion and in equilibrium.
#include "sim/control/controllers/blend.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.h"
#include "common/file.h"
#include "sim/control/rigid_motion.h"
#include "sim/pose.h"
#include "tests/common/temporary_folder.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

constexpr double kStep = 0.05;

TetMesh bar() { return box_mesh({2, 6, 2}, {0.2, 0.6, 0.2}, {0, 0, 0}); }

// The bar with its top turned by 120 degrees.
RowMatrixXd twisted(const TetMesh& mesh) {
  PoseHandle bottom, top;
  bottom.region = {"bottom", {0, 0, 0}, {1, 0, 1}};
  top.region = {"top", {0, 1, 0}, {1, 1, 1}};
  top.angle = 2;
  return solve_pose(sim_mesh(mesh), settings(model_schema(), "{}"), std::vector{bottom, top}).V;
}

BodyInput blended(const std::string& keys, const std::string& space = "examples") {
  const TetMesh mesh = bar();
  BodyInput input = box_input(mesh, {.controller = "{type: blend, keys: " + keys + "}"});
  input.rest_space = space;
  input.examples = {{"twisted", "", twisted(mesh)}};
  return input;
}
World world(const BodyInput& input, bool statics) {
  return {{input}, {}, {Eigen::Vector3d::Zero(), kStep, statics}};
}

std::unique_ptr<Controller> controller(const std::string& yaml) {
  static const Vector mass = Vector::Ones(4), rest = Vector::Ones(12);
  static const ControlledBody body{mass, rest, 1, 9.81, kStep, {}, Matrix::Identity(2, 2)};
  return make_controller(body, settings(controller_schema(), yaml));
}

TEST(Blend, FollowsItsKeyframes) {
  const auto linear = controller("{type: blend, keys: [{t: 1, weights: [0, 1]}, {t: 3, weights: [1, 0.5]}]}");
  const auto smooth = controller(
      "{type: blend, between: smooth, keys: [{t: 1, weights: [0, 1]}, {t: 3, weights: [1, 0.5]}]}");
  const auto at = [](const auto& blend, double t) -> Vector { return *blend->rest_parameters(t); };
  for (const auto* blend : {&linear, &smooth}) {
    EXPECT_EQ(at(*blend, 0), Eigen::Vector2d(0, 1));
    EXPECT_EQ(at(*blend, 1), Eigen::Vector2d(0, 1));
    EXPECT_EQ(at(*blend, 2), Eigen::Vector2d(0.5, 0.75));
    EXPECT_EQ(at(*blend, 3), Eigen::Vector2d(1, 0.5));
    EXPECT_EQ(at(*blend, 99), Eigen::Vector2d(1, 0.5));
  }
  EXPECT_NEAR(at(linear, 1.5)[0], 0.25, 1e-15);
  EXPECT_NEAR(at(smooth, 1.5)[0], 3.0 / 16 - 2.0 / 64, 1e-15);
  EXPECT_FALSE(controller("{type: rest}")->rest_parameters(0).has_value());
}

TEST(Blend, RefusesKeysThatDoNotFit) {
  EXPECT_THROW(controller("{type: blend, keys: [{t: 1, weights: [0, 0]}, {t: 1, weights: [1, 1]}]}"), Error);
  EXPECT_THROW(controller("{type: blend, keys: [{t: 1, weights: [0, 0]}, {t: 2, weights: [1]}]}"), Error);
  try {
    world(blended("[{t: 0, weights: [0, 1]}]"), false);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_THAT(error.what(), testing::HasSubstr("2 weights and the rest space has 1 example"));
  }
}

TEST(Blend, MovesABodyWithoutPushingIt) {
  World moving = world(blended("[{t: 0, weights: [0]}, {t: 0.5, weights: [1]}]"), false);
  const Body& body = moving.body(0);
  const Eigen::Vector3d start = centre_of_mass(body.model().mass, body.x());
  for (int i = 1; i <= 20; ++i) {
    moving.step();
    EXPECT_NEAR(body.p()[0], std::min(1.0, i * kStep / 0.5), 1e-12);
    EXPECT_EQ(moving.records().back().method, "keyed");
    EXPECT_LE(moving.records().back().residual_rel, kFinishTolerance);
  }
  EXPECT_LE((centre_of_mass(body.model().mass, body.x()) - start).norm(), 1e-9);
  EXPECT_GT((body.x() - flat(bar().V)).lpNorm<Eigen::Infinity>(), 0.05);
}

// Acceptance: a weight of one gives the example, a weight of zero the rest shape.
TEST(Statics, ReachTheExampleAndComeBack) {
  for (const std::string space : {"examples", "strains"}) {
    const BodyInput input =
        blended("[{t: 0, weights: [0]}, {t: 0.5, weights: [1]}, {t: 1, weights: [0]}]", space);
    World still = world(input, true);
    const Body& body = still.body(0);
    const Vector &mass = body.model().mass, example = flat(input.examples[0].V);
    const auto away_from = [&](const Vector& shape) {
      const Eigen::Matrix3d R = best_rotation(mass, shape, body.x());
      const Eigen::Vector3d from = centre_of_mass(mass, shape), to = centre_of_mass(mass, body.x());
      return (rigid(R, to - R * from, shape) - body.x()).lpNorm<Eigen::Infinity>();
    };
    for (int i = 1; i <= 20; ++i) {
      const Vector before = body.x();
      still.step();
      EXPECT_EQ(still.records().back().method, "static");
      EXPECT_EQ(body.v().norm(), 0);
      // No rigid motion from step to step.
      EXPECT_LE((centre_of_mass(mass, body.x()) - centre_of_mass(mass, before)).norm(), 1e-12);
      EXPECT_LE((best_rotation(mass, before, body.x()) - Eigen::Matrix3d::Identity()).norm(), 1e-7);
      if (i == 10) {
        EXPECT_LE(away_from(example), 1e-6) << space;
      }
    }
    EXPECT_LE(away_from(flat(bar().V)), 1e-6) << space;
  }
}

TEST(Statics, BeginAtTheFirstKeyframe) {
  const BodyInput input = blended("[{t: 0, weights: [1]}]");
  const World still = world(input, true);
  const Vector &x = still.body(0).x(), example = flat(input.examples[0].V);
  for (int i = 0; i < input.rest.V.rows(); ++i) {
    EXPECT_NEAR((x.segment<3>(3 * i) - x.head<3>()).norm(),
                (example.segment<3>(3 * i) - example.head<3>()).norm(), 1e-6);
  }
}

TEST(Statics, GoOnFromASavedFrame) {
  const BodyInput input = blended("[{t: 0, weights: [0.2]}, {t: 0.5, weights: [1]}]");
  const testing_support::TemporaryFolder folder;
  World whole = world(input, true);
  for (int i = 0; i < 4; ++i) whole.step();
  Hdf5Writer file;
  whole.save(file);
  write_file_atomic(folder / "frame.h5", file.image());
  World later = world(input, true);
  later.restore(Hdf5Reader(folder / "frame.h5"));
  for (int i = 0; i < 4; ++i) {
    whole.step();
    later.step();
  }
  EXPECT_EQ(whole.body(0).x(), later.body(0).x());
}

}  // namespace
}  // namespace vivify::sim
