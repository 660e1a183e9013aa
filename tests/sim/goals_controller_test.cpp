// Goals written in YAML: what they ask for, when, and of which part of a body.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/control/controller.h"
#include "sim/control/rigid_motion.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

using testing::HasSubstr;

struct Actor {
  explicit Actor(const std::string& yaml)
      : mesh(standing_box()),
        mass(lumped_mass(sim_mesh(mesh), 300 * tet_volumes(mesh))),
        rest(flat(mesh.V)),
        body{mass, rest, 1, 9.81, 0.1},
        controller(make_controller(body, settings(controller_schema(), yaml))) {}
  std::vector<Goal> step() { return controller->goals({rest, Vector::Zero(rest.size()), 0}); }

  TetMesh mesh;
  Vector mass, rest;
  ControlledBody body;
  std::unique_ptr<Controller> controller;
};

TEST(GoalsController, FollowsKeysOfTheCentre) {
  Actor actor(
      "{type: goals, goals: [{along: [0, 2, 0], weight: 4, frequency: 5,"
      " keys: [{t: 0.1, value: 0}, {t: 0.3, value: 0.4, rate: 1}]}]}");
  const double height = centre_of_mass(actor.mass, actor.rest).y();
  const std::vector<std::pair<double, double>> wanted = {{0, 2}, {0.2, 2.5}, {0.4, 1}, {0.4, 1}};
  for (const auto& [value, rate] : wanted) {
    const std::vector<Goal> goals = actor.step();
    ASSERT_EQ(goals.size(), 1U);
    EXPECT_NEAR(goals[0].kd, std::sqrt(4 * actor.mass.sum()), 1e-12);
    EXPECT_NEAR(goals[0].kp, 5 * goals[0].kd, 1e-12);
    EXPECT_NEAR(goals[0].sx, height + value, 1e-12);
    EXPECT_NEAR(goals[0].sv, rate, 1e-12);
    EXPECT_NEAR(goals[0].a.dot(actor.rest), height, 1e-12);
  }
}

TEST(GoalsController, SeesRegionsFromTheCentre) {
  Actor actor(
      "{type: goals, goals: [{of: region, region: {min: [0, 0.9, 0]}, from_centre: true, frequency: 1, keys: "
      "[{value: 0.1}]}]}");
  const Goal goal = actor.step().at(0);
  EXPECT_NEAR(goal.sx, 1 - centre_of_mass(actor.mass, actor.rest).y() + 0.1, 1e-12) << "the top is at 1 m";
  Vector lifted = actor.rest;
  for (Eigen::Index i = 1; i < lifted.size(); i += 3) lifted[i] += 3;
  EXPECT_NEAR(goal.a.dot(lifted), goal.a.dot(actor.rest), 1e-12) << "moved as a whole, it is where it was";
}

TEST(GoalsController, SpinsAndBeginsAgain) {
  Actor actor(
      "{type: goals, period_s: 0.3, goals: [{of: spin, along: [0, 0, 1], keys: [{rate: 1}, {t: 0.2, rate: "
      "3}]}]}");
  std::vector<double> rates;
  for (int step = 0; step < 6; ++step) rates.push_back(actor.step().at(0).sv);
  EXPECT_NEAR(rates[0], 2, 1e-12);
  EXPECT_NEAR(rates[1], 3, 1e-12);
  EXPECT_NEAR(rates[3], 2, 1e-9) << "after the period";
  const Goal goal = actor.step().at(0);
  EXPECT_EQ(goal.kp, 0);
  Vector turning(actor.rest.size());
  const Eigen::Vector3d centre = centre_of_mass(actor.mass, actor.rest);
  for (Eigen::Index i = 0; i < actor.mass.size(); ++i)
    turning.segment<3>(3 * i) = Eigen::Vector3d(0, 0, 7).cross(spatial_point(actor.rest, i, 3) - centre);
  EXPECT_NEAR(goal.a.dot(turning), 7, 1e-9);
}

TEST(GoalsController, RefusesWhatMeansNothing) {
  const auto message = [](const std::string& goal) -> std::string {
    try {
      Actor actor("{type: goals, goals: [" + goal + "]}");
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      return error.what();
    }
    return {};
  };
  EXPECT_THAT(message("{along: [0, 0, 0], keys: [{}]}"), HasSubstr("along must not be 0"));
  EXPECT_THAT(message("{keys: [{t: 1}, {t: 1}]}"), HasSubstr("in the order of time"));
  EXPECT_THAT(message("{keys: [{value: 0.2}]}"), HasSubstr("a value that stays asks for nothing"));
  EXPECT_THAT(message("{of: region, region: {min: [0.4, 0.44, 0.4], max: [0.41, 0.45, 0.41]}, keys: [{}]}"),
              HasSubstr("goals[0]"));
}

}  // namespace
}  // namespace vivify::sim
