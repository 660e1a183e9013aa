// The roll controller: round bodies roll and do not slide, and restored controllers go on alike.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "bench/bodies.h"
#include "sim/control/rigid_motion.h"
#include "sim/world.h"

namespace vivify::sim {
namespace {

using bench::settings;
using Vector = Eigen::VectorXd;

struct Journey {
  Eigen::Vector3d travel = Eigen::Vector3d::Zero();  // of the centre of mass, m
  double turned = 0;                                 // about `axle`, radians
};

Journey roll(const SimMesh& mesh, const std::string& model, const std::string& controller,
             const Eigen::Vector3d& axle) {
  const BodyInput input = bench::body_input("round", mesh, model, controller);
  const WorldSettings settings;
  World world({input}, bench::ground(), settings);
  const Body& body = world.body(0);
  const Vector& mass = body.model().mass;
  const Vector rest = body.x();
  Eigen::Matrix3d before = Eigen::Matrix3d::Identity();
  Journey journey;
  while (world.time() < 4) {
    world.step();
    const Eigen::Matrix3d now = best_rotation(mass, rest, body.x());
    const Eigen::AngleAxisd turn(now * before.transpose());
    journey.turned += turn.angle() * turn.axis().dot(axle);
    before = now;
  }
  journey.travel = centre_of_mass(mass, body.x()) - centre_of_mass(mass, rest);
  return journey;
}

TEST(Roll, ABallRollsAlongItsHeading) {
  const SimMesh ball = bench::ball(0.25, 2, 1);
  const double heading = 30 * M_PI / 180;
  const Eigen::Vector3d forward(std::sin(heading), 0, std::cos(heading));
  const Journey journey = roll(ball, bench::lively_model("solid3d", ball), "{type: roll, heading_deg: 30}",
                               Eigen::Vector3d::UnitY().cross(forward));
  EXPECT_GE(journey.travel.dot(forward), 3 * 0.5) << "three diameters";
  EXPECT_LT(journey.travel.cross(forward).norm(), 0.1);
  EXPECT_NEAR(journey.turned * 0.25, journey.travel.dot(forward), 0.25 * journey.travel.dot(forward));
}

TEST(Roll, ADiscRollsInItsPlane) {
  const SimMesh disc = bench::disc(0.25, 4);
  const Journey journey = roll(disc, bench::lively_model("solid2d", disc),
                               "{type: roll, heading_deg: -90, speed: 0.8}", Eigen::Vector3d::UnitZ());
  EXPECT_LE(journey.travel.x(), -3 * 0.5);
  EXPECT_GE(journey.travel.x(), -0.8 * 4) << "no faster than asked";
  EXPECT_NEAR(journey.turned * 0.25, -journey.travel.x(), -0.25 * journey.travel.x());
}

struct Roller {
  explicit Roller(const std::string& yaml)
      : mesh(bench::disc(0.25, 2)),
        mass(Vector::Constant(mesh.V.rows(), 0.1)),
        rest(Eigen::Map<const Vector>(mesh.V.data(), mesh.V.size())),
        body{mass, rest, 0.5, 9.81, 0.02},
        controller(make_controller(body, settings(controller_schema(), yaml))) {}
  std::vector<Goal> goals(double load = 100) {
    return controller->goals({rest, Vector::Zero(rest.size()), load});
  }
  SimMesh mesh;
  Vector mass, rest;
  ControlledBody body;
  std::unique_ptr<Controller> controller;
};

TEST(Roll, AsksNothingInTheAir) {
  Roller roller("{type: roll, heading_deg: 90}");
  EXPECT_TRUE(roller.goals(0).empty());
  EXPECT_EQ(roller.controller->phase(), "flight");
  EXPECT_FALSE(roller.goals().empty());
  EXPECT_EQ(roller.controller->phase(), "roll");
}

TEST(Roll, AsksForMoreWhileItFallsShortAndNotWithoutEnd) {
  Roller roller("{type: roll, heading_deg: 90, speed: 0.5, ramp_s: 0.2}");
  double asked = 0;
  for (int step = 0; step < 10; ++step) {
    const double now = roller.goals().front().sv;
    EXPECT_GT(now, asked);
    asked = now;
  }
  EXPECT_NEAR(asked, 0.5, 0.05);
  for (int step = 0; step < 500; ++step) asked = roller.goals().front().sv;
  EXPECT_NEAR(asked, 1, 1e-12) << "twice the speed";
}

TEST(Roll, RestoredControllersGoOnAlike) {
  const std::string yaml = "{type: roll, heading_deg: 90}";
  Roller a(yaml), b(yaml);
  for (int step = 0; step < 17; ++step) a.goals();
  b.controller->restore(a.controller->state());
  EXPECT_EQ(a.controller->phase(), b.controller->phase());
  const std::vector<Goal> from_a = a.goals(), from_b = b.goals();
  ASSERT_EQ(from_a.size(), from_b.size());
  for (std::size_t i = 0; i < from_a.size(); ++i) EXPECT_EQ(from_a[i].sv, from_b[i].sv);
}

TEST(Roll, NeedsGravityAndAHeadingInItsPlane) {
  EXPECT_THROW(Roller("{type: roll, heading_deg: 0}"), Error);
  Roller roller("{type: roll, heading_deg: 90}");
  const ControlledBody floating{roller.mass, roller.rest, 0.5, 0, 0.02};
  EXPECT_THROW(make_controller(floating, settings(controller_schema(), "{type: roll, heading_deg: 90}")),
               Error);
}

}  // namespace
}  // namespace vivify::sim
