// The hop controller on a scripted body: phases, geometry of its goals, restart.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "sim/control/controller.h"
#include "sim/control/rigid_motion.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

struct Hopper {
  explicit Hopper(const std::string& yaml =
                      "{type: hop, crouch_depth: 0.02, crouch_s: 0.25, thrust_s: 0.15, land_s: 0.25}")
      : mesh(standing_box()),
        mass(lumped_mass(sim_mesh(mesh), 300 * tet_volumes(mesh))),
        rest(flat(mesh.V)),
        body{mass, rest, 1, 9.81, 0.02},
        controller(make_controller(body, settings(controller_schema(), yaml))) {}
  std::vector<Goal> goals(bool standing) {
    return controller->goals({rest, Vector::Zero(rest.size()), standing ? mass.sum() * 9.81 : 0});
  }
  // Advances until the phase begins; returns the steps it took.
  int advance(const std::string& phase, bool standing) {
    for (int step = 0; step < 1000; ++step) {
      if (controller->phase() == phase) return step;
      goals(standing);
    }
    ADD_FAILURE() << "never in phase " << phase;
    return -1;
  }
  // Wanted velocity of the centre of mass, from the velocity goals.
  Eigen::Vector3d wanted_velocity(const std::vector<Goal>& all) const {
    Eigen::Vector3d wanted = Eigen::Vector3d::Zero();
    for (const Goal& goal : all) {
      for (int axis = 0; axis < 3; ++axis) {
        const Vector along = centre_of_mass_weights(mass, Eigen::Vector3d::Unit(axis));
        // Goals of the centre of mass give the same weight to a coordinate per mass everywhere.
        Vector shift = Vector::Zero(rest.size());
        for (Eigen::Index i = axis; i < rest.size(); i += 3) shift[i] = 1;
        if (is_centre_goal(goal)) wanted[axis] += goal.a.dot(shift) * goal.sv;
      }
    }
    return wanted;
  }
  // Sum of the goals that are not of the centre of mass, as turning about the axes through it.
  Eigen::Vector3d wanted_turning(const Vector& x, const std::vector<Goal>& all) const {
    Eigen::Vector3d wanted = Eigen::Vector3d::Zero();
    const Eigen::Vector3d centre = centre_of_mass(mass, x);
    for (const Goal& goal : all) {
      if (is_centre_goal(goal)) continue;
      Vector turning(x.size());
      for (int axis = 0; axis < 3; ++axis) {
        for (Eigen::Index i = 0; i < x.size(); i += 3)
          turning.segment<3>(i) =
              Eigen::Vector3d::Unit(axis).cross(Eigen::Vector3d(x.segment<3>(i)) - centre);
        wanted[axis] += goal.a.dot(turning) * goal.sv;
      }
    }
    return wanted;
  }
  bool is_centre_goal(const Goal& goal) const {
    const Eigen::Vector3d direction = goal.a.head<3>() / mass[0] * mass.sum();
    return (goal.a - centre_of_mass_weights(mass, direction)).norm() < 1e-9 * goal.a.norm();
  }

  TetMesh mesh;
  Vector mass, rest;
  ControlledBody body;
  std::unique_ptr<Controller> controller;
};

TEST(Hop, PhasesFollowOneAnother) {
  Hopper hopper;
  hopper.goals(true);
  EXPECT_EQ(hopper.controller->phase(), "crouch");
  EXPECT_NEAR(hopper.advance("thrust", true), 0.25 / 0.02, 2);
  hopper.goals(true);
  hopper.goals(true);
  EXPECT_EQ(hopper.controller->phase(), "thrust");
  hopper.advance("flight", false);
  EXPECT_TRUE(hopper.goals(false).empty()) << "no internal force moves the centre of mass in flight";
  hopper.advance("land", true);
  EXPECT_NEAR(hopper.advance("crouch", true), 0.25 / 0.02, 2);
}

TEST(Hop, AsksNothingInTheAirBeforeItHasLanded) {
  Hopper hopper;
  for (int step = 0; step < 100; ++step) EXPECT_TRUE(hopper.goals(false).empty());
  hopper.goals(true);
  EXPECT_EQ(hopper.controller->phase(), "crouch");
  EXPECT_TRUE(hopper.goals(false).empty()) << "a foot that lifts in the crouch";
}

TEST(Hop, CrouchesOnWhateverGroundItStands) {
  Hopper hopper("{type: hop, crouch_depth: 0.2, crouch_s: 0.25}");
  Vector raised = hopper.rest;
  for (Eigen::Index i = 1; i < raised.size(); i += 3) raised[i] += 3;
  double lowest = 10;
  const auto goals = [&] {
    return hopper.controller->goals({raised, Vector::Zero(raised.size()), hopper.mass.sum() * 9.81});
  };
  goals();
  while (hopper.controller->phase() == "crouch") {
    for (const Goal& goal : goals()) {
      if (goal.kp > 0) lowest = std::min(lowest, goal.sx);
    }
  }
  EXPECT_NEAR(lowest, 3 + 0.5 - 0.2, 1e-3);
}

TEST(Hop, NeedsGravity) {
  Hopper hopper;
  const ControlledBody floating{hopper.mass, hopper.rest, 1, 0, 0.02};
  EXPECT_THROW(make_controller(floating, settings(controller_schema(), "{type: hop}")), Error);
}

TEST(Hop, TriesAgainWhenItDoesNotLeaveTheGround) {
  Hopper hopper;
  hopper.goals(true);
  hopper.advance("thrust", true);
  EXPECT_NEAR(hopper.advance("land", true), 2 * 0.15 / 0.02, 2);
}

TEST(Hop, StartsOverAfterAnEndlessFlight) {
  Hopper hopper;
  hopper.goals(true);
  hopper.advance("thrust", true);
  hopper.advance("flight", false);
  EXPECT_NEAR(hopper.advance("land", false) * 0.02, 3, 0.05);
}

TEST(Hop, ThrustReachesTheAskedHeightAndHeading) {
  for (const double heading : {0.0, 90.0, -30.0, 180.0}) {
    Hopper hopper("{type: hop, height: 0.2, pace: 0.5, heading_deg: " + std::to_string(heading) + "}");
    hopper.goals(true);
    hopper.advance("thrust", true);
    Eigen::Vector3d wanted = Eigen::Vector3d::Zero();
    for (int step = 0; step < 5; ++step) wanted = hopper.wanted_velocity(hopper.goals(true));
    EXPECT_NEAR(wanted.y(), std::sqrt(2 * 9.81 * 0.2), 1e-9);
    const double angle = heading * std::numbers::pi / 180;
    const double speed = std::hypot(wanted.x(), wanted.z());
    EXPECT_GT(speed, 0.5);  // faster than the pace, as it stands still in between
    EXPECT_NEAR(wanted.x(), speed * std::sin(angle), 1e-9);
    EXPECT_NEAR(wanted.z(), speed * std::cos(angle), 1e-9);
  }
}

TEST(Hop, CrouchLowersTheCentreOfMass) {
  Hopper hopper("{type: hop, crouch_depth: 0.2, crouch_s: 0.25}");
  double lowest = 1;
  hopper.goals(true);
  while (hopper.controller->phase() == "crouch") {
    for (const Goal& goal : hopper.goals(true)) {
      if (goal.kp > 0) lowest = std::min(lowest, goal.sx);
    }
  }
  EXPECT_NEAR(lowest, 0.5 - 0.2, 1e-3);
}

TEST(Hop, UprightGoalsTurnATiltedBodyBack) {
  Hopper hopper;
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const Vector x = rigid(R, {0, 0, 0}, hopper.rest);
  const Eigen::Vector3d wanted =
      hopper.wanted_turning(x, hopper.controller->goals({x, Vector::Zero(x.size()), 1e9}));
  EXPECT_LT(wanted.x(), -0.5);
  EXPECT_NEAR(wanted.tail<2>().norm(), 0, 1e-6);
}

// The spin goals are linear in the rate: one of a tilted body gives their scale.
TEST(Hop, FlightLeadsTheFeetAheadByAShareOfTheCapturePoint) {
  const auto thrust = [](Hopper& hopper, const Vector& x, double speed) {
    hopper.advance("thrust", true);
    for (int step = 0; step < 5; ++step) hopper.goals(true);
    Vector v = Vector::Zero(x.size());
    for (Eigen::Index i = 2; i < v.size(); i += 3) v[i] = speed;
    return hopper.wanted_turning(x, hopper.controller->goals({x, v, 1e9})).x();
  };
  Hopper upright;
  const double tilt = 0.2;
  const Eigen::Matrix3d R = Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const double per_rate = thrust(upright, rigid(R, {0, 0, 0}, upright.rest), 0) / (-8 * std::sin(tilt));
  const auto rate = [&](double speed) {
    Hopper hopper("{type: hop, height: 0.25, thrust_s: 0.15, feet_ahead: 0.5}");
    return thrust(hopper, hopper.rest, speed) / per_rate;
  };
  const double flight = 2 * std::sqrt(2 * 0.25 / 9.81);
  const double rise = centre_of_mass(upright.mass, upright.rest).y() - lowest_height(upright.rest, 3);
  const double tangent = 0.5 * 0.4 / std::sqrt(9.81 * rise);
  EXPECT_NEAR(rate(0.4), -std::sin(std::atan(tangent)) / flight, 1e-6);
  EXPECT_NEAR(rate(-0.4), -rate(0.4), 1e-9);
  EXPECT_NEAR(rate(0), 0, 1e-9);
  EXPECT_NEAR(rate(10), -std::sin(std::atan(0.3)) / flight, 1e-6) << "at most so far";
}

TEST(Hop, GoesBackToItsPlaceWhenItIsMoved) {
  Hopper hopper("{type: hop, to: [0, 0, 1]}");
  const auto stand_at = [&](double z) {
    const Vector x = rigid(Eigen::Matrix3d::Identity(), {0, 0, z}, hopper.rest);
    return hopper.controller->goals({x, Vector::Zero(x.size()), hopper.mass.sum() * 9.81});
  };
  hopper.goals(true);
  hopper.advance("thrust", true);
  hopper.advance("flight", false);
  for (int step = 0; step < 30; ++step) stand_at(1);
  EXPECT_TRUE(hopper.controller->arrived());
  for (int step = 0; step < 30; ++step) stand_at(1.1);
  EXPECT_EQ(hopper.controller->phase(), "land") << "near enough";
  for (int step = 0; step < 60 && hopper.controller->phase() != "thrust"; ++step) stand_at(1.6);
  stand_at(1.6);
  EXPECT_EQ(hopper.controller->phase(), "thrust");
  EXPECT_LT(hopper.wanted_velocity(stand_at(1.6)).z(), -0.1);
  EXPECT_TRUE(hopper.controller->arrived()) << "the next behaviour has begun";
}

TEST(Hop, RestoredControllersGoOnAlike) {
  Hopper a, b;
  for (int step = 0; step < 17; ++step) a.goals(true);
  b.controller->restore(a.controller->state());
  for (int step = 0; step < 60; ++step) {
    const bool standing = step % 25 < 12;
    const std::vector<Goal> from_a = a.goals(standing), from_b = b.goals(standing);
    ASSERT_EQ(from_a.size(), from_b.size());
    EXPECT_EQ(a.controller->phase(), b.controller->phase());
    for (std::size_t i = 0; i < from_a.size(); ++i) {
      EXPECT_EQ(from_a[i].sx, from_b[i].sx);
      EXPECT_EQ(from_a[i].sv, from_b[i].sv);
      EXPECT_EQ(from_a[i].a, from_b[i].a);
    }
  }
}

TEST(RestController, AsksForNothing) {
  Hopper hopper("{type: rest}");
  EXPECT_TRUE(hopper.goals(true).empty());
  EXPECT_EQ(hopper.controller->phase(), "rest");
}

}  // namespace
}  // namespace vivify::sim
