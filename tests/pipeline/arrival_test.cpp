// Where a script leads to, and what is said of a body that is not there, from tables made up for it.
#include "pipeline/arrival.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config.h"
#include "pipeline/body_settings.h"
#include "sim/step_record.h"

namespace vivify::pipeline {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Place = Eigen::Vector3d;

Value body(const std::string& motion) {
  std::vector<Error> errors;
  Value body =
      resolve(body_schema(), parse_yaml("{name: ball, mesh: ball.obj, " + motion + "}", "scene.yaml", errors),
              errors);
  EXPECT_THAT(errors, IsEmpty());
  return body;
}

// A cube of 1 m on the ground, whose centre goes straight from a place to another within 2 s.
struct Journey {
  Place from = {0, 0.5, 0}, to = {0, 0.5, 0};
  double set_out = 0;  // when its second behaviour begins, s
  bool stands = true;

  Arrival judged(const std::string& motion) const {
    const Value settings = body(motion);
    std::string csv = sim::csv_header();
    for (int step = 0; step <= 40; ++step) {
      sim::StepRecord record;
      record.body = "ball";
      record.t = 0.05 * step;
      record.com = from + (to - from) * step / 40.0;
      record.vel = (to - from) / 2 * (step % 2);  // which takes a grip on the ground
      record.contacts = stands ? 3 : 0;
      record.behavior = record.t >= set_out ? 1 : 0;
      csv += csv_line(record);
    }
    return judge_arrival(settings, destination(settings).value(), StepTable(csv), 9.81, cube(from), cube(to));
  }
  static RowMatrixXd cube(const Place& centre) {
    RowMatrixXd V(2, 3);
    V << -0.5, -0.5, -0.5, 0.5, 0.5, 0.5;
    return V.rowwise() + centre.transpose();
  }
};

TEST(Arrival, TheLastTravelThatEndsLeadsThere) {
  const auto leads_to = [](const std::string& motion) { return destination(body(motion)); };
  EXPECT_EQ(leads_to("controller: {type: hop, to: [1, 2, 3]}")->place, Place(1, 2, 3));
  const auto last =
      leads_to("behavior: [{hop: {to: [9, 0, 0]}}, {roll: {path: [[4, 0, 0], [5, 0, 6]]}}, {wait: }]");
  EXPECT_EQ(last->place, Place(5, 0, 6));
  EXPECT_EQ(last->behavior, 1);
  EXPECT_EQ(leads_to("behavior: [{hop: {to: [1, 0, 0]}}, {hop: {count: 1, pace: 0}}, {wait: }]")->place,
            Place(1, 0, 0));
  for (const char* endless : {"heading_deg: 90", "chase: cup", "flee: cup", "for_s: 2"}) {
    EXPECT_FALSE(
        leads_to(std::string("behavior: [{roll: {to: [1, 0, 0]}}, {roll: {") + endless + "}}, {wait: }]"))
        << endless;
  }
  EXPECT_FALSE(leads_to("controller: {type: rest}"));
}

TEST(Arrival, WhoHasNotSetOutHasNotArrived) {
  const Journey waits = {.set_out = 9};
  EXPECT_THAT(waits.judged("behavior: [{wait: {until: cup.arrived}}, {roll: {to: [3, 0, 0]}}]").reasons,
              ElementsAre("the clip ended before it set out, at behavior[0].wait until cup.arrived"));
  const Arrival there = waits.judged("behavior: [{hop: {to: [5, 0, 0]}}, {roll: {to: [0, 0, 0]}}]");
  EXPECT_FALSE(there.arrived);
  EXPECT_THAT(there.reasons, ElementsAre("the clip ended before it set out, at behavior[0].hop"));
}

TEST(Progression, TellsWhatNeverBegan) {
  const Value script =
      body("behavior: [{roll: {heading_deg: 0, until: cup.arrived}}, {wait: }, {turn: {by_deg: 90}}]");
  const auto reached = [&](int last) {
    std::string csv = sim::csv_header();
    for (int behavior = 0; behavior <= last; ++behavior) {
      sim::StepRecord record;
      record.body = "ball";
      record.behavior = behavior;
      csv += csv_line(record);
    }
    return progression(script, StepTable(csv));
  };
  EXPECT_EQ(
      describe("ball", reached(0)),
      "ball: the clip ended at behavior[0].roll until cup.arrived; behavior[1].wait and behavior[2].turn "
      "never began");
  EXPECT_THAT(reached(1).never_began, ElementsAre("behavior[2].turn"));
  EXPECT_THAT(reached(2).never_began, IsEmpty());
  EXPECT_THAT(reached(-1).never_began, ElementsAre("behavior[1].wait", "behavior[2].turn"))
      << "it has just appeared";
}

TEST(Arrival, GoingDownIsNoFault) {
  const Journey down = {.from = {0, 0.5, 0}, .to = {4, -3, 0}};
  EXPECT_TRUE(down.judged("controller: {type: roll, to: [4, 0, 0]}").arrived);
  EXPECT_THAT(down.judged("controller: {type: roll, to: [6, 0, 0]}").reasons,
              ElementsAre("the clip ended while it was on its way, at 2.00 m/s"));
  EXPECT_THAT(down.judged("controller: {type: roll, to: [4, 2, 0]}").reasons,
              ElementsAre("the place is 1.00 m above its head, and it travels on the ground"));
}

TEST(Arrival, NeedsGround) {
  const Journey falls = {.to = {0, -30, 0}, .stands = false};
  EXPECT_THAT(falls.judged("controller: {type: hop, to: [4, 0, 0]}").reasons,
              ElementsAre("it touched no ground"));
}

TEST(Arrival, OnlyTheTravelItselfTellsAboutTheGround) {
  const Journey slips = {.to = {0.01, 0.5, 0}, .set_out = 1};
  const Arrival arrival = slips.judged("behavior: [{wait: {for_s: 1}}, {roll: {to: [3, 0, 0]}}]");
  ASSERT_EQ(arrival.reasons.size(), 1);
  EXPECT_THAT(arrival.reasons[0], testing::StartsWith("the ground gave it no hold"));
  EXPECT_NEAR(arrival.missing, 2.99, 1e-12);
}

}  // namespace
}  // namespace vivify::pipeline
