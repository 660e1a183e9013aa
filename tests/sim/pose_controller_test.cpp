// The pose controller: an example is taken, held and left.
#include "sim/control/controllers/pose.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/file.h"
#include "sim/control/behavior.h"
#include "sim/control/rigid_motion.h"
#include "tests/common/temporary_folder.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TetMesh block() { return box_mesh({2, 3, 2}, {0.4, 0.45, 0.4}, {-0.2, 1e-4, -0.2}); }

// The block with what is above `from` of its height moved by `move` times how far above it is, from 0 to 1.
RowMatrixXd sheared(const TetMesh& mesh, double from, const Eigen::RowVector3d& move) {
  RowMatrixXd V = mesh.V;
  for (Eigen::Index i = 0; i < V.rows(); ++i)
    V.row(i) += std::max(0.0, (V(i, 1) / 0.45 - from) / (1 - from)) * move;
  return V;
}

BodyInput actor(const std::string& behavior) {
  const TetMesh mesh = block();
  BodyInput input =
      box_input(mesh, {.model = "{type: solid3d, density: 100, stiffness: 80000, volume_stiffness: 80000}"});
  input.rest_space = "examples";
  input.examples = {{"bow", "", sheared(mesh, 0.4, {0.12, -0.05, 0})},
                    {"back", "", sheared(mesh, 0, {-0.1, 0, 0})}};
  const Schema schema = object("A body.").field("behavior", behavior_schema());
  input.behavior = settings(schema, "behavior: " + behavior)["behavior"];
  return input;
}

World world(const std::string& behavior) { return {{actor(behavior)}, one(plane(1)), {}}; }

// It starts from the weights that the one before has come to: half of another pose.
TEST(PoseController, TakesAnExampleHoldsItAndLeavesIt) {
  World stage = world(
      "[{blend: {keys: [{t: 0, weights: [0, 0]}, {t: 0.2, weights: [0, 0.5]}]}},"
      " {pose: {example: bow, take_s: 0.5, hold_s: 0.5, leave_s: 0.5}}, {wait: }]");
  const Body& body = stage.body(0);
  std::vector<std::string> phases;
  Vector before = body.p();
  while (stage.time() < 2.5) {
    stage.step();
    const StepRecord& r = stage.records().back();
    EXPECT_LE(r.residual_rel, 1e-8);
    EXPECT_LT(r.tilt_deg, 30);
    EXPECT_LE((body.p() - before).norm(), 0.08) << "without a jump, at " << stage.time();
    before = body.p();
    if (phases.empty() || phases.back() != r.phase) phases.push_back(r.phase);
    if (r.phase == "hold") {
      EXPECT_EQ(body.p(), Eigen::Vector2d(1, 0));
    }
  }
  EXPECT_THAT(phases, ElementsAre("blend", "take", "hold", "leave", "stand"));
  EXPECT_LT(body.p().norm(), 0.05);
  EXPECT_LT(stage.records().back().tilt_deg, 1);
}

// A cage comes as near to the pose as it can, and stands on the same soles.
TEST(PoseController, ACageTakesAPoseToo) {
  BodyInput input =
      actor("[{wait: {for_s: 0.2}}, {pose: {example: back, take_s: 0.5, hold_s: 0.5}}, {wait: }]");
  input.rest_space = "cage";
  World stage({input}, one(plane(1)), {});
  const Body& body = stage.body(0);
  const RestSpace& space = *body.model().rest;
  const Vector back = space.basis() * (space.basis().transpose() * space.poses().col(1));
  const double before = stage.body(0).x().maxCoeff();
  bool held = false;
  while (stage.time() < 2.5) {
    stage.step();
    const StepRecord& r = stage.records().back();
    EXPECT_LE(r.residual_rel, 1e-8);
    EXPECT_LT(r.tilt_deg, 30);
    if (r.phase != "hold") continue;
    held = true;
    EXPECT_LE((body.p() - back).norm(), 1e-12);
  }
  EXPECT_TRUE(held);
  EXPECT_GT(back.norm(), 0.05);
  EXPECT_NEAR(body.x().maxCoeff(), before, 0.02);
  EXPECT_LT(stage.records().back().tilt_deg, 1);
}

TEST(PoseController, GoesOnFromASavedFrame) {
  const std::string script = "[{pose: {example: bow, take_s: 0.1, hold_s: 0.1, leave_s: 0.1}}]";
  const testing_support::TemporaryFolder folder;
  World whole = world(script);
  for (int i = 0; i < 9; ++i) whole.step();
  Hdf5Writer file;
  whole.save(file);
  write_file_atomic(folder / "frame.h5", file.image());
  World later = world(script);
  later.restore(Hdf5Reader(folder / "frame.h5"));
  for (int i = 0; i < 9; ++i) {
    whole.step();
    later.step();
    ASSERT_EQ(whole.body(0).x(), later.body(0).x());
    ASSERT_EQ(whole.body(0).p(), later.body(0).p());
    ASSERT_EQ(whole.records().back().phase, later.records().back().phase);
  }
  EXPECT_TRUE(whole.body(0).controller().arrived());
}

TEST(PoseController, NamesTheExamplesThereAre) {
  try {
    world("[{pose: {example: curtsy}}]");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_THAT(error.what(), HasSubstr("example = curtsy: the body has no such example"));
    EXPECT_THAT(error.hint(), HasSubstr("bow, back"));
    EXPECT_GT(error.where().line, 0);
  }
  BodyInput caged = actor("[{pose: {example: bow}}]");
  caged.rest_space = "cage";
  caged.examples.clear();
  EXPECT_THROW(World({caged}, one(plane(1)), {}), Error);
}

}  // namespace
}  // namespace vivify::sim
