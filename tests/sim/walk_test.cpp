// The walk controller: support polygons, its steps on a scripted body and on a solid of space, restart.
// Scenes that walk are in tests/pipeline/walk_scenes_test.cpp.
#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "bench/bodies.h"
#include "sim/control/controller.h"
#include "sim/control/support.h"
#include "tests/pipeline/walk_steps.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

TEST(Support, ThePointOfTheHullThatIsNearest) {
  const Support square({{0, 1, 0}, {2, 0, 0}, {1, 5, 1}, {2, 0, 2}, {0, 0, 2}, {0.5, 0, 1.5}});
  EXPECT_TRUE(square.middle().isApprox(Eigen::Vector3d(1, 0, 1)));
  EXPECT_EQ(square.nearest({0.3, 9, 1.9}), Eigen::Vector3d(0.3, 0, 1.9)) << "inside";
  EXPECT_TRUE(square.nearest({3, 0, 1.5}).isApprox(Eigen::Vector3d(2, 0, 1.5)));
  EXPECT_TRUE(square.nearest({3, 0, -1}).isApprox(Eigen::Vector3d(2, 0, 0)));
  EXPECT_TRUE(square.nearest({3, 0, 1}, 0.5).isApprox(Eigen::Vector3d(1.5, 0, 1)));
}

TEST(Support, OfALineAndOfAPoint) {
  const Support line({{1, 0, 0}, {3, 2, 0}, {2, 0, 0}});
  EXPECT_TRUE(line.nearest({1.5, 0, 0}).isApprox(Eigen::Vector3d(1.5, 0, 0)));
  EXPECT_TRUE(line.nearest({9, 0, 0}, 0.5).isApprox(Eigen::Vector3d(2.5, 0, 0)));
  const Support point({{1, 7, 2}});
  EXPECT_TRUE(point.nearest({5, 0, 5}).isApprox(Eigen::Vector3d(1, 0, 2)));
}

// A controller of its own, to which a body at rest is shown.
struct Shown {
  explicit Shown(const std::string& yaml)
      : mesh(bench::letter({"####", "####", "#..#", "#..#"}, 1, 0.25)),
        mass(Vector::Constant(mesh.V.rows(), 5)),
        rest(flat(mesh.V)),
        body{mass, rest, 1, 9.81, 0.02},
        controller(make_controller(body, settings(controller_schema(), yaml))) {}
  std::vector<Goal> goals(Controller& shown, double slide) const {
    const double weight = 9.81 * mass.sum();
    Vector x = rest, loads = Vector::Zero(mass.size());
    for (Eigen::Index i = 0; i < mass.size(); ++i) {
      if (mesh.V(i, 1) > 1e-9) x[2 * i] += slide;  // the feet stay
      if (mesh.V(i, 1) < 1e-9) loads[i] = weight / 4;
    }
    return shown.goals({x, Vector::Zero(x.size()), weight, {}, {}, loads});
  }
  SimMesh mesh;
  Vector mass, rest;
  ControlledBody body;
  std::unique_ptr<Controller> controller;
};

TEST(Walk, ARestoredControllerGoesOnAlike) {
  const std::string yaml =
      "{type: walk, feet: [{min: [0, 0, 0], max: [0.3, 0, 1]}, {min: [0.7, 0, 0], max: [1, 0, 1]}]}";
  const Shown a(yaml), b(yaml);
  std::set<std::string> phases;
  for (int step = 0; step < 60; ++step) {
    b.controller->restore(a.controller->state());
    const double slide = -0.01 * step;  // over the left foot, which lets the right one step
    const std::vector<Goal> ours = a.goals(*a.controller, slide), theirs = b.goals(*b.controller, slide);
    ASSERT_EQ(ours.size(), theirs.size());
    for (std::size_t i = 0; i < ours.size(); ++i) {
      EXPECT_EQ(ours[i].a, theirs[i].a);
      EXPECT_EQ(ours[i].sx, theirs[i].sx);
      EXPECT_EQ(ours[i].sv, theirs[i].sv);
    }
    EXPECT_EQ(a.controller->state(), b.controller->state());
    phases.insert(a.controller->phase());
  }
  EXPECT_EQ(phases, (std::set<std::string>{"shift1", "swing1", "shift0"})) << "the one in front begins";
}

TEST(Walk, TakesNoSmallStepsWhereTheWayEnds) {
  const std::string feet =
      ", feet: [{min: [0, 0, 0], max: [0.3, 0, 1]}, {min: [0.7, 0, 0], max: [1, 0, 1]}]}";
  const Shown near("{type: walk, step: 0.5, to: [0.1, 0, 0]" + feet),
      far("{type: walk, step: 0.5, to: [0.3, 0, 0]" + feet);
  near.goals(*near.controller, 0);
  EXPECT_EQ(near.controller->phase(), "stand");
  EXPECT_TRUE(near.controller->arrived());
  far.goals(*far.controller, 0);
  EXPECT_EQ(far.controller->phase(), "shift1");
  EXPECT_FALSE(far.controller->arrived());
}

// Sideways, on two legs.
TEST(Walk, ABodyOfSpaceRocksFromFootToFoot) {
  SimMesh mesh = bench::cells(4, 4, 2, 0.25, [](int x, int y, int) { return y > 1 || x == 0 || x == 3; });
  mesh.V.col(1).array() += 1e-3;
  BodyInput input = bench::body_input(
      "stool", mesh, bench::lively_model("solid3d", mesh, 200),
      "{type: walk, heading_deg: 90, swing_s: 0.2, upright: 30, feet: [{min: [0, 0, 0], max: [0.3, 0, 1]},"
      " {min: [0.7, 0, 0], max: [1, 0, 1]}]}");
  input.cage_weights = bench::spread_weights(mesh.V, 24);
  World world({input}, bench::ground(), {});
  const Body& body = world.body(0);
  std::vector<RowMatrixXd> frames = {rows(body.x())};
  while (world.time() < 2.5) {
    world.step();
    EXPECT_LT(world.records().back().tilt_deg, 10) << "at " << world.time();
    if (world.records().size() % 2 == 0) frames.push_back(rows(body.x()));
  }
  constexpr double kHeight = 1;
  EXPECT_GE(testing_support::count_steps(frames, testing_support::foot_of(frames[0], true), kHeight, 1), 2);
  EXPECT_GE(testing_support::count_steps(frames, testing_support::foot_of(frames[0], false), kHeight, 1), 2);
}

TEST(Walk, NeedsFeetThatHoldVertices) {
  EXPECT_THROW(Shown("{type: walk, feet: [{min: [0, 0, 0], max: [0.3, 0.1, 1]}, "
                     "{min: [0.4, 0, 0], max: [0.6, 0.1, 1]}]}"),
               Error)
      << "between the legs";
}

}  // namespace
}  // namespace vivify::sim
