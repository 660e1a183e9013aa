// The turn controller: a body that hops looks where it was told to, on the spot.
#include "sim/control/controllers/turn.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/file.h"
#include "sim/control/behavior.h"
#include "sim/control/body_goals.h"
#include "sim/control/rigid_motion.h"
#include "tests/common/temporary_folder.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

using testing::HasSubstr;

BodyInput hopper(const std::string& behavior) {
  BodyInput input =
      box_input(small_box(), {.model = "{type: solid3d, stiffness: 60000, volume_stiffness: 60000}"});
  input.rest.V.col(1).array() += 1e-4;
  const Schema schema = object("A body.").field("behavior", behavior_schema());
  input.behavior = settings(schema, "behavior: " + behavior)["behavior"];
  return input;
}

double yaw_deg(const Body& body) {
  const Eigen::Matrix3d R = best_rotation(body.model().mass, flat(body.model().mesh.V), body.x());
  return yaw_of(R) * 180 / std::numbers::pi;
}

// Each from where the one before has left the body.
TEST(Turn, ReachesTheAngleOnTheSpot) {
  World world(
      {hopper("[{turn: {by_deg: 90}}, {wait: {for_s: 0.1}}, {turn: {by_deg: 180, per_hop_deg: 60}},"
              " {wait: {for_s: 0.1}}, {turn: {to_deg: 0}}, {wait: {for_s: 0.1}}, {turn: {by_deg: -90}}]")},
      one(plane(1)), {});
  const Body& body = world.body(0);
  const Eigen::Vector3d start = centre_of_mass(body.model().mass, body.x());
  std::vector<double> yaws;
  std::string before;
  while (world.time() < 14 && !body.controller().arrived()) {
    world.step();
    const StepRecord& r = world.records().back();
    EXPECT_LE(r.residual_rel, 1e-8);
    EXPECT_LT(r.tilt_deg, 20) << "at " << world.time();
    if (r.phase == "stand" && before != "stand") yaws.push_back(yaw_deg(body));
    before = r.phase;
  }
  ASSERT_TRUE(body.controller().arrived());
  ASSERT_EQ(yaws.size(), 3u);
  EXPECT_NEAR(yaws[0], 90, 5);
  EXPECT_NEAR(std::abs(std::remainder(yaws[1] - 270, 360)), 0, 9) << "by 180 from there";
  EXPECT_NEAR(yaws[2], 0, 5);
  EXPECT_NEAR(std::remainder(yaw_deg(body) - yaws[2] + 90, 360), 0, 5);
  EXPECT_LT((centre_of_mass(body.model().mass, body.x()) - start).norm(), 0.25) << "half its height";
}

TEST(Turn, LooksAtAnotherBody) {
  BodyInput mouse = hopper("[{rest: }]");
  mouse.name = "mouse";
  mouse.rest.V.rowwise() += Eigen::RowVector3d(-2, 0, -2);
  World world({hopper("[{turn: {towards: mouse, per_hop_deg: 60}}]"), mouse}, one(plane(1)), {});
  while (world.time() < 5 && !world.body(0).controller().arrived()) world.step();
  EXPECT_TRUE(world.body(0).controller().arrived());
  EXPECT_NEAR(yaw_deg(world.body(0)), -135, 5);
}

TEST(Turn, GoesOnFromASavedFrame) {
  const std::string script = "[{turn: {by_deg: 60, per_hop_deg: 20}}]";
  const testing_support::TemporaryFolder folder;
  World whole({hopper(script)}, one(plane(1)), {});
  for (int i = 0; i < 70; ++i) whole.step();
  ASSERT_GT(yaw_deg(whole.body(0)), 10) << "in its second hop";
  Hdf5Writer file;
  whole.save(file);
  write_file_atomic(folder / "frame.h5", file.image());
  World later({hopper(script)}, one(plane(1)), {});
  later.restore(Hdf5Reader(folder / "frame.h5"));
  for (int i = 0; i < 60; ++i) {
    whole.step();
    later.step();
    ASSERT_EQ(whole.body(0).x(), later.body(0).x()) << i;
    ASSERT_EQ(whole.records().back().phase, later.records().back().phase);
  }
}

TEST(Turn, WantsOneDirectionAndABodyOfSpace) {
  const auto faults = [](const std::string& yaml, bool planar) {
    std::vector<Error> errors;
    check_turn(settings(turn_controller_schema(), yaml), "b", planar, errors);
    std::string text;
    for (const Error& error : errors) text += std::string(error.what()) + "\n";
    return text;
  };
  EXPECT_EQ(faults("{by_deg: 5}", false), "");
  EXPECT_THAT(faults("{}", false), HasSubstr("b needs one of by_deg, to_deg and towards"));
  EXPECT_THAT(faults("{by_deg: 5, to_deg: 3}", false), HasSubstr("needs one of"));
  EXPECT_THAT(faults("{by_deg: 5}", true), HasSubstr("a body of the plane cannot turn"));
  EXPECT_THROW(World({hopper("[{turn: }]")}, one(plane(1)), {}), Error);
  EXPECT_THROW(World({hopper("[{turn: {by_deg: 5}}]")}, one(plane(1)), {Eigen::Vector3d::Zero()}), Error);
}

}  // namespace
}  // namespace vivify::sim
