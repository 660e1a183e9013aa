// Scripts of behaviours: their order and conditions, and real bodies that follow them.
#include "sim/control/behavior.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/control/rigid_motion.h"
#include "sim/world.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Value script_of(const std::string& yaml) {
  const Schema schema = object("A body.").field("behavior", behavior_schema());
  return settings(schema, "behavior: " + yaml)["behavior"];
}

// A box that stands or not, as it is told.
struct Actor {
  explicit Actor(const std::string& yaml)
      : mesh(standing_box()),
        mass(lumped_mass(sim_mesh(mesh), 300 * tet_volumes(mesh))),
        rest(flat(mesh.V)),
        body{mass, rest, 1, 9.81, 0.02, {}, Matrix::Ones(1, 1)},
        script(make_script(body, script_of(yaml))) {}
  std::size_t step(Others others = {}) {
    return script->goals({rest, Vector::Zero(rest.size()), 9.81 * mass.sum(), {}, others}).size();
  }
  TetMesh mesh;
  Vector mass, rest;
  ControlledBody body;
  std::unique_ptr<Controller> script;
};

TEST(Behavior, OneFollowsAnother) {
  Actor actor("[{wait: {for_s: 0.1}}, {rest: {for_s: 0.06}}, {hop: {count: 2}}]");
  std::vector<std::string> phases;
  for (int step = 0; step < 9; ++step) {
    actor.step();
    phases.push_back(actor.script->phase());
    EXPECT_EQ(actor.script->passive(), phases.back() == "rest");
  }
  EXPECT_THAT(phases,
              ElementsAre("stand", "stand", "stand", "stand", "stand", "rest", "rest", "rest", "crouch"));
  EXPECT_FALSE(actor.script->arrived());
}

TEST(Behavior, APoseOfKeyframesIsHeldAndLeft) {
  Actor actor(
      "[{wait: {for_s: 0.04}}, {blend: {keys: [{t: 0, weights: [0]}, {t: 0.06, weights: [1]}]}}, {wait: }]");
  std::vector<double> weights;
  for (int step = 0; step < 6; ++step) {
    actor.step();
    if (const auto p = actor.script->rest_parameters(99)) weights.push_back((*p)[0]);
  }
  EXPECT_THAT(weights, testing::Pointwise(testing::DoubleNear(1e-12), {1.0 / 3, 2.0 / 3, 1.0}));
  EXPECT_EQ(actor.script->phase(), "stand");
}

TEST(Behavior, WaitsForOthersAndArrives) {
  Actor actor("[{wait: {until: ball.arrived}}, {wait: }]");
  std::vector<OtherBody> others = {{"cube", {0, 0, 0}, true}, {"ball", {0, 0, 0}, false}};
  for (int step = 0; step < 100; ++step) actor.step(others);
  EXPECT_FALSE(actor.script->arrived());
  others[1].arrived = true;
  actor.step(others);
  EXPECT_TRUE(actor.script->arrived());
  actor.step(others);
  EXPECT_TRUE(actor.script->arrived()) << "the last one goes on";
}

TEST(Behavior, TheLastOneArrivesAsItsConditionSaysAndGoesOn) {
  Actor timed("[{wait: {for_s: 0.02}}, {wait: {for_s: 0.1}}]"), other("[{wait: {until: ball.arrived}}]");
  std::vector<OtherBody> others = {{"ball", {0, 0, 0}, false}};
  for (int step = 0; step < 7; ++step) {
    EXPECT_FALSE(timed.script->arrived()) << step;
    timed.step();
    other.step(others);
  }
  EXPECT_TRUE(timed.script->arrived());
  EXPECT_EQ(timed.script->behavior(), 1);
  EXPECT_EQ(timed.script->phase(), "stand");
  EXPECT_FALSE(other.script->arrived());
  others[0].arrived = true;
  other.step(others);
  EXPECT_TRUE(other.script->arrived());
}

TEST(Behavior, RestoredScriptsGoOnAlike) {
  const std::string yaml = "[{wait: {for_s: 0.1}}, {hop: {to: [1, 0, 0], for_s: 0.2}}]";
  Actor a(yaml), b(yaml);
  for (int step = 0; step < 11; ++step) a.step();
  b.script->restore(a.script->state());
  for (int step = 0; step < 20; ++step) {
    EXPECT_EQ(a.step(), b.step());
    EXPECT_EQ(a.script->state(), b.script->state());
  }
}

TEST(Behavior, TellsWhomItLooksAt) {
  const Value script = script_of("[{hop: {chase: mouse}}, {wait: {until: cat.arrived}}]");
  const auto seen = looked_at(script.items()[0]["hop"]), awaited = looked_at(script.items()[1]["wait"]);
  EXPECT_EQ(seen.at(0).first + " " + seen.at(0).second.as_string(), "chase mouse");
  EXPECT_EQ(awaited.at(0).first + " " + awaited.at(0).second.as_string(), "until cat");
  try {
    Actor actor("[{wait: {until: cat.gone}}]");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("until = cat.gone must be NAME.arrived"));
  }
}

// Laws and ends of a whole journey: two hops to a place aside, a wait, one hop on the spot with a turn.
TEST(Behavior, ABodyHopsToAPlaceWaitsAndTurns) {
  BodyInput input =
      box_input(small_box(), {.model = "{type: solid3d, stiffness: 60000, volume_stiffness: 60000}"});
  input.rest.V.col(1).array() += 1e-4;
  input.behavior = script_of(
      "[{hop: {to: [0.8, 0, 0.6], height: 0.1, pace: 0.4}}, {wait: {for_s: 0.3}},"
      " {hop: {count: 1, pace: 0, height: 0.15, turn_deg: 60}}]");
  World world({input}, one(plane(1)), {});
  const Body& body = world.body(0);
  double waited = 0;
  while (world.time() < 6 && !body.controller().arrived()) {
    world.step();
    EXPECT_LE(world.records().back().residual_rel, 1e-8);
    if (body.controller().phase() != "stand") continue;
    waited += 1.0 / 48;
    const Eigen::Vector3d centre = centre_of_mass(body.model().mass, body.x());
    EXPECT_NEAR(centre.x(), 0.8, 0.1);
    EXPECT_NEAR(centre.z(), 0.6, 0.1);
  }
  EXPECT_TRUE(body.controller().arrived());
  EXPECT_NEAR(waited, 0.3, 0.03);
  const Eigen::Matrix3d R = best_rotation(body.model().mass, flat(body.model().mesh.V), body.x());
  EXPECT_NEAR(std::atan2(R(0, 2), R(2, 2)) * 180 / std::numbers::pi, 60, 20);
  EXPECT_GT(R(1, 1), 0.9) << "upright";
}

}  // namespace
}  // namespace vivify::sim
