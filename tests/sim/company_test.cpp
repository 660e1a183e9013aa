// Controlled characters and passive bodies together, on colliders that move.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <set>

#include "bench/bodies.h"
#include "sim/control/rigid_motion.h"
#include "sim/settings.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

constexpr double kAbove = 1e-4;  // the ground at the start, m

BodyInput moved(BodyInput input, const std::string& name, const Eigen::Vector3d& by) {
  input.name = name;
  input.rest.V.rowwise() += by.transpose();
  return input;
}

// 0.5 m high.
BodyInput hopper(const std::string& controller) {
  const Scene scene = {.model = "{type: solid3d, stiffness: 60000, volume_stiffness: 60000}",
                       .controller = controller};
  return moved(box_input(small_box(), scene), "hopper", {0, kAbove, 0});
}

constexpr const char* kLight =
    "{type: solid3d, density: 100, stiffness: 20000, volume_stiffness: 20000, damping_s: 0.01}";
constexpr const char* kHeavy =
    "{type: solid3d, density: 400, stiffness: 100000, volume_stiffness: 100000, damping_s: 0.01}";

BodyInput passive(const std::string& name, SimMesh mesh, double x, const std::string& model = kLight) {
  return moved(bench::body_input(name, std::move(mesh), model, "{}"), name, {x, kAbove, 0});
}

// An endless floor that moves.
Collider moving_floor(RigidPath motion, const Eigen::Vector3d& surface_velocity = Eigen::Vector3d::Zero()) {
  return Collider("floor", make_collider_shape(settings(collider_shape_schema(), "{type: plane}"), {}), 1,
                  std::move(motion), surface_velocity);
}

Eigen::Vector3d centre(const World& world, int b) {
  return centre_of_mass(world.body(b).model().mass, world.body(b).x());
}

// What was seen of all bodies. Each obeys its equations of motion: 1e-8 of its weight in every row.
struct Watch {
  double penetration = 0;       // m
  double smallest_element = 1;  // of its size at rest
  double tilt_deg = 0;          // of body 0
  int flights = 0;              // of body 0
  std::set<int> touched;        // bodies that touched body 0
  std::string phase;

  template <class AtStep>
  void run(World& world, double seconds, const AtStep& at_step) {
    while (world.time() < seconds) {
      world.step();
      const auto first = world.records().end() - world.body_count();
      for (auto record = first; record != world.records().end(); ++record) {
        ASSERT_LE(record->residual_rel, 1e-8) << record->body << ", step " << record->step;
        penetration = std::max(penetration, record->max_penetration);
        smallest_element = std::min(smallest_element, record->min_element_ratio);
      }
      tilt_deg = std::max(tilt_deg, first->tilt_deg);
      flights += first->phase == "flight" && phase != "flight" ? 1 : 0;
      phase = first->phase;
      for (const PairMemory& touching : world.touching()) {
        if (touching.identity.body_a == 0) touched.insert(touching.identity.body_b);
      }
      at_step();
    }
  }
  void run(World& world, double seconds) {
    run(world, seconds, [] {});
  }
};

TEST(Company, AHopperHopsOnALift) {
  const double seconds = 4;
  const RigidPath path({{0, {0, 0, 0}, {0, 0, 0}, {}}, {seconds, {0, 0.8, 0}, {0, 0, 0}, {}}}, false);
  World world({hopper("{type: hop, height: 0.1, pace: 0}")}, one(moving_floor(path)), {});
  const Eigen::Vector3d start = centre(world, 0);
  Watch watch;
  double lowest = INFINITY, highest = -INFINITY, aside = 0;
  watch.run(world, seconds, [&] {
    const Eigen::Vector3d relative = centre(world, 0) - path.pose(world.time()) * start;
    lowest = std::min(lowest, relative.y());
    highest = std::max(highest, relative.y());
    aside = std::max(aside, std::hypot(relative.x(), relative.z()));
  });
  EXPECT_GE(watch.flights, 4);
  EXPECT_GT(highest, 0.06);
  EXPECT_LT(highest, 0.4);
  EXPECT_GT(lowest, -0.15);
  EXPECT_LT(aside, 0.05);
  EXPECT_LT(watch.tilt_deg, 5);
  EXPECT_LT(watch.penetration, 0.005);
}

TEST(Company, AHopperGoesAlongWithThePlatform) {
  const double seconds = 4;
  const RigidPath path({{0, {0, 0, 0}, {0, 0, 0}, {}}, {seconds, {1, 0, 0.5}, {0, 0, 0}, {}}}, false);
  World world({hopper("{type: hop, height: 0.1, pace: 0}")}, one(moving_floor(path)), {});
  const Eigen::Vector3d start = centre(world, 0);
  Watch watch;
  watch.run(world, seconds);
  EXPECT_GE(watch.flights, 4);
  const Eigen::Vector3d relative = centre(world, 0) - path.pose(world.time()) * start;
  EXPECT_LT(std::hypot(relative.x(), relative.z()), 0.1);
}

TEST(Company, APlatformThatMovesAndTurnsCarriesABox) {
  const double seconds = 3;
  const RigidPath path({{0, {0, 0, 0}, {0, 0, 0}, {}}, {seconds, {1, 0.3, -0.5}, {0, 90, 0}, {}}}, false);
  World world({passive("box", bench::box(3, 3, 3, 0.1), 0.4)}, one(moving_floor(path)), {});
  const Eigen::Vector3d start = centre(world, 0);
  Watch watch;
  double off = 0;
  watch.run(world, seconds, [&] {
    off = std::max(off, (path.pose(world.time()).inverse() * centre(world, 0) - start).norm());
  });
  EXPECT_LT(off, 0.01);
}

TEST(Company, ABeltCarriesABoxAtItsSpeed) {
  const Eigen::Vector3d belt(0.4, 0, -0.3);
  World world({passive("box", bench::box(3, 3, 3, 0.1), 0)}, one(moving_floor({}, belt)), {});
  Watch watch;
  watch.run(world, 2);
  const Eigen::Vector3d before = centre(world, 0);
  watch.run(world, 3);
  EXPECT_LT((centre(world, 0) - before - belt).norm(), 1e-4);
  EXPECT_LT((centre_of_mass(world.body(0).model().mass, world.body(0).v()) - belt).norm(), 1e-4);
}

TEST(Company, AHopperCrossesARowOfSoftObstacles) {
  std::vector<BodyInput> bodies = {hopper("{type: hop, heading_deg: 90, height: 0.15, pace: 0.4}")};
  for (int i = 0; i < 3; ++i) {
    bodies.push_back(
        passive("obstacle" + std::to_string(i), bench::box(1, 1, 4, 0.08), 0.45 + 0.4 * i, kHeavy));
  }
  World world(bodies, bench::ground(), {});
  Watch watch;
  watch.run(world, 5);
  EXPECT_GE(watch.touched.size(), 2u);
  for (int b = 1; b < 4; ++b) {
    EXPECT_GT(centre(world, 0).x(), centre(world, b).x() + 0.25);
    EXPECT_NEAR(centre(world, b).y(), 0.04, 0.01) << "lies on the ground";
  }
  EXPECT_LT(watch.tilt_deg, 40);
  EXPECT_GT(watch.smallest_element, 0);
  EXPECT_LT(watch.penetration, 0.005);
}

TEST(Company, AHopperPushesASoftBallOneMetre) {
  World world({hopper("{type: hop, heading_deg: 90, height: 0.12, pace: 0.4}"),
               passive("ball", bench::ball(0.2, 2, 1), 0.5)},
              bench::ground(), {});
  const Eigen::Vector3d before = centre(world, 1);
  const Vector p = world.body(1).p();
  Watch watch;
  watch.run(world, 4);
  EXPECT_GE((centre(world, 1) - before).x(), 1);
  EXPECT_EQ(watch.touched, std::set<int>{1});
  EXPECT_EQ(world.body(1).p(), p) << "a passive body keeps its rest shape";
  EXPECT_NEAR(centre(world, 1).y(), 0.2, 0.04) << "the ball lies on the ground";
  EXPECT_GT(watch.smallest_element, 0.3);
  EXPECT_LT(watch.penetration, 0.005);
}

// Without a floor: a box thrown against a wall, another box or onto one. In the air it wants nothing.
TEST(Company, WhatPushesSidewaysCarriesNobody) {
  struct Case {
    Eigen::Vector3d place, velocity;  // of the hopper beside what it meets
    bool stands;
  };
  for (const Case& c : {Case{{-0.52, 0, 0}, {2, 0, 0}, false}, Case{{0, 0.52, 0}, {0, -2, 0}, true}}) {
    BodyInput thrown = moved(hopper("{type: roll}"), "thrown", c.place), met = hopper("{type: rest}");
    met.name = "met";
    thrown.velocity = c.velocity;
    World world({thrown, met}, {}, {{0, -9.81, 0}, 0.01});
    double pushed = 0;
    bool stood = false;
    for (int step = 0; step < 30; ++step) {
      world.step();
      const auto record = world.records().end() - 2;
      stood |= record->phase != "flight";
      for (const PairMemory& touching : world.touching()) pushed += touching.normal_force;
    }
    EXPECT_GT(pushed, world.body(0).model().weight) << "they met";
    EXPECT_EQ(stood, c.stands);
  }
  std::vector<Collider> wall;
  ShapePlace place;
  place.pose.linear() = Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  place.pose.translation().x() = 0.3;
  wall.emplace_back("wall", make_collider_shape(settings(collider_shape_schema(), "{type: plane}"), place),
                    1.0);
  BodyInput thrown = hopper("{type: roll}");
  thrown.velocity = {2, 0, 0};
  World world({thrown}, std::move(wall), {{0, -9.81, 0}, 0.01});
  int touched = 0;
  for (int step = 0; step < 30; ++step) {
    world.step();
    touched += world.records().back().contacts;
    EXPECT_EQ(world.records().back().phase, "flight") << step;
  }
  EXPECT_GT(touched, 0);
}

}  // namespace
}  // namespace vivify::sim
