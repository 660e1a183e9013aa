// Bodies that appear in the world at a time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "sim/control/rigid_motion.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

using testing::HasSubstr;

constexpr double kH = 1.0 / 48, kGravity = 9.81;
constexpr const char* kStiff =
    "{type: solid3d, stiffness: 200000, volume_stiffness: 200000, damping_s: 0.01}";

// A passive box of 0.4 by 0.5 by 0.45 m whose lower side is at `place`.
BodyInput box(const std::string& name, const Eigen::Vector3d& place, double spawn = 0) {
  TetMesh mesh = small_box();
  mesh.V.rowwise() += place.transpose();
  BodyInput input = box_input(mesh, {.model = kStiff});
  input.name = name;
  input.spawn = spawn;
  return input;
}

std::vector<StepRecord> records_of(const World& world, const std::string& body) {
  std::vector<StepRecord> records;
  for (const StepRecord& record : world.records()) {
    if (record.body == body) records.push_back(record);
  }
  return records;
}

Error failure(World& world, int steps) {
  try {
    for (int step = 0; step < steps; ++step) world.step();
  } catch (const Error& error) {
    return error;
  }
  return {ErrorKind::internal, "nothing was thrown"};
}

TEST(Spawn, ABodyFallsFromTheTimeAtWhichItAppears) {
  BodyInput late = box("late", {0, 5, 0}, 10 * kH);
  late.velocity = {0.3, 0, 0};
  World world({late}, {}, {.h = kH});
  const Vector rest = flat(late.rest.V);
  for (int step = 0; step < 10; ++step) {
    EXPECT_FALSE(world.present(0));
    world.step();
    EXPECT_EQ(world.body(0).x(), rest);
    EXPECT_TRUE(world.records().empty());
    EXPECT_TRUE(world.islands().empty());
  }
  EXPECT_TRUE(world.present(0));
  for (int n = 1; n <= 10; ++n) {
    world.step();
    const StepRecord& r = world.records().back();
    EXPECT_EQ(r.step, 10 + n);
    EXPECT_LE((r.vel - Eigen::Vector3d(0.3, -n * kH * kGravity, 0)).norm(), 1e-9);
  }
  EXPECT_EQ(world.records().size(), 10u);
}

// A time between two steps counts from the next one; rounding of a time that is meant does not.
TEST(Spawn, TakesTheNextStep) {
  for (const auto& [spawn, steps] :
       std::vector<std::pair<double, long>>{{0, 0}, {0.1 * kH, 1}, {3 * kH, 3}, {0.1 + 0.2, 15}, {1, 48}}) {
    EXPECT_EQ(World({box("a", {0, 0, 0}, spawn)}, {}, {.h = kH}).body(0).spawn_step(), steps) << spawn;
  }
}

TEST(Spawn, WhatIsNotThereChangesNothing) {
  World alone({box("a", {0, 0.01, 0})}, one(plane(1)), {.h = kH});
  World before({box("a", {0, 0.01, 0}), box("ghost", {0.1, 0.02, 0}, 100)}, one(plane(1)), {.h = kH});
  for (int step = 0; step < 20; ++step) {
    alone.step();
    before.step();
  }
  EXPECT_EQ(alone.body(0).x(), before.body(0).x());
  EXPECT_EQ(before.records().size(), 20u);
  EXPECT_EQ(before.islands(), (std::vector<std::vector<int>>{{0}}));
}

TEST(Spawn, LateBodiesPileUp) {
  World world(
      {box("first", {0, 0.001, 0}), box("second", {0.03, 0.52, 0}, 0.5), box("third", {0, 1.05, 0}, 1)},
      one(plane(1)), {.h = kH});
  for (int step = 0; step < 120; ++step) world.step();
  EXPECT_EQ(world.islands(), (std::vector<std::vector<int>>{{0, 1, 2}}));
  for (int b = 0; b < 3; ++b) {
    const Body& body = world.body(b);
    EXPECT_NEAR(centre_of_mass(body.model().mass, body.x()).y(), 0.25 + 0.5 * b, 0.04);
    EXPECT_LE(body.v().lpNorm<Eigen::Infinity>(), 2e-2);
  }
  EXPECT_EQ(records_of(world, "first").size(), 120u);
  EXPECT_EQ(records_of(world, "second").size(), 96u);
  EXPECT_EQ(records_of(world, "third").size(), 72u);
  for (const StepRecord& record : world.records()) EXPECT_LE(record.residual_rel, 1e-8);
}

TEST(Spawn, InsideAnotherBodyIsRefused) {
  World world({box("a", {0, 0, 0}), box("b", {0, 0.4, 0.02}, 5 * kH)}, {}, {{0, 0, 0}, kH});
  const Error error = failure(world, 10);
  EXPECT_EQ(world.steps(), 5);
  EXPECT_EQ(error.kind(), ErrorKind::geometry);
  EXPECT_THAT(error.what(), HasSubstr("bodies 'a' and 'b' are, when one appears at 0.1041"));
  EXPECT_THAT(error.what(), HasSubstr(" s, 0.1 m inside each other; contact resolves at most 0.01 m"));
}

TEST(Spawn, InsideAColliderIsRefused) {
  World world({box("sunk", {0, -0.2, 0}, 2 * kH)}, one(plane(1)), {.h = kH});
  const Error error = failure(world, 10);
  EXPECT_EQ(error.kind(), ErrorKind::geometry);
  EXPECT_THAT(error.what(), HasSubstr("body 'sunk' appears at 0.0416"));
  EXPECT_THAT(error.what(), HasSubstr("s, 0.2 m inside collider 'plane'"));
}

TEST(Spawn, ALittleInsideIsPushedOut) {
  World world({box("a", {0, -0.004, 0}, 0.25)}, one(plane(1)), {.h = kH});
  for (int step = 0; step < 100; ++step) world.step();
  EXPECT_GT(world.body(0).x()(Eigen::seqN(1, world.body(0).x().size() / 3, 3)).minCoeff(), -0.001);
}

TEST(Spawn, GoesOnFromAnyFrameWithTheSameBits) {
  const auto file =
      std::filesystem::temp_directory_path() / ("vivify_spawn_" + std::to_string(getpid()) + ".h5");
  const auto make = [] {
    BodyInput late = box("late", {0.05, 0.52, 0}, 12 * kH);
    late.controller = box_input(small_box(), {.controller = "{type: hop, crouch_s: 0.1}"}).controller;
    return World({late, box("first", {0, 0.001, 0})}, one(plane(1)), {.h = kH});
  };
  World whole = make();
  std::vector<std::string> lines;
  for (int step = 0; step < 30; ++step) {
    whole.step();
  }
  for (const StepRecord& record : whole.records()) lines.push_back(csv_line(record));
  for (const int cut : {6, 12, 13, 20}) {
    World first = make();
    for (int step = 0; step < cut; ++step) first.step();
    Hdf5Writer saved;
    first.save(saved);
    saved.save(file);
    World resumed = make();
    const Hdf5Reader reader(file);
    EXPECT_EQ(reader.has("/bodies/late/x"), cut >= 12);
    resumed.restore(reader);
    for (int step = cut; step < 30; ++step) resumed.step();
    for (int b = 0; b < 2; ++b) EXPECT_EQ(resumed.body(b).x(), whole.body(b).x()) << cut;
    ASSERT_FALSE(resumed.records().empty());
    const std::size_t skipped = lines.size() - resumed.records().size();
    for (std::size_t i = 0; i < resumed.records().size(); ++i)
      EXPECT_EQ(csv_line(resumed.records()[i]), lines[skipped + i]);
  }
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace vivify::sim
