// Bodies that appear at a time: simulated, drawn and followed from then on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/file.h"
#include "common/hdf5_file.h"
#include "render/film.h"
#include "tests/pipeline/program.h"
#include "tests/pipeline/simulated_run.h"
#include "tests/pipeline/tiny_scene.h"

namespace vivify::pipeline {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing_support::Outcome;
using testing_support::Steps;
using testing_support::TinyScene;
using testing_support::vivify;

constexpr const char* kSecond =
    "  - {name: late, mesh: ball.obj, position: [0, 2, 0], tetrahedra: {backend: tetgen, vertices: 60},\n"
    "     rest_space: {type: cage, vertices: 8, harmonic_unknowns: 500}, spawn_s: 0.125, looks: {all: "
    "clay}}\n"
    "colliders:";

Outcome run(const std::string& command, const TinyScene& scene, std::vector<std::string> options = {}) {
  std::vector<std::string> arguments = {command, scene.file().string(), "-o", scene.out().string(),
                                        "--progress=none"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  return vivify(arguments);
}

bool is_drawn(const TinyScene& scene, int frame, int id) {
  const render::Film film =
      render::decode_exr(read_file(scene.out() / ("render/tiny.000" + std::to_string(frame) + ".exr")));
  return std::find(film.id.begin(), film.id.end(), static_cast<float>(id)) != film.id.end();
}

// Of the six frames of the tiny scene the fourth is at 0.125 s.
TEST(Spawn, ABodyIsSimulatedAndDrawnFromItsTimeOn) {
  TinyScene scene;
  scene.change("colliders:", kSecond);
  scene.change("follow: ball", "follow: late");
  scene.change("position: [0, 1, 4], target: [0, 0.5, 0]", "position: [0, 1.2, 6], target: [0, 1.2, 0]");
  const Outcome outcome = run("render", scene);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  for (int frame = 1; frame <= 6; ++frame) {
    EXPECT_TRUE(is_drawn(scene, frame, 1)) << frame;
    EXPECT_EQ(is_drawn(scene, frame, 2), frame >= 4) << frame;
    EXPECT_TRUE(is_drawn(scene, frame, 3)) << "the plate keeps its number";
    const Hdf5Reader state(scene.out() / ("sim/frames/000" + std::to_string(frame) + ".h5"));
    EXPECT_TRUE(state.has("/bodies/ball/x"));
    EXPECT_EQ(state.has("/bodies/late/x"), frame >= 4) << frame;
  }
  EXPECT_EQ(Hdf5Reader(scene.out() / "sim/frames/0004.h5").matrix("/bodies/late/x"),
            Hdf5Reader(scene.out() / "mesh/late.h5").matrix("/X0"));
  const json bodies = json::parse(read_text_file(scene.out() / "sim/summary.json")).at("bodies");
  EXPECT_EQ(bodies.at("ball").at("steps"), 10);
  EXPECT_EQ(bodies.at("late").at("steps"), 4);
  EXPECT_GT(bodies.at("late").at("dofs"), 100);
}

TEST(Spawn, GoesOnFromAFrameBeforeAndAfter) {
  TinyScene scene;
  scene.change("colliders:", kSecond);
  ASSERT_EQ(run("simulate", scene).code, 0);
  const auto whole = testing_support::files_below(scene.out() / "sim");
  for (const char* part : {"1-2", "1-4"}) {
    std::filesystem::remove_all(scene.out() / "sim");
    ASSERT_EQ(run("simulate", scene, {"--frames", part}).code, 0);
    ASSERT_EQ(run("simulate", scene).code, 0);
    EXPECT_EQ(testing_support::files_below(scene.out() / "sim"), whole) << part;
  }
}

TEST(Spawn, InsideAnotherBodyEndsTheRun) {
  TinyScene scene;
  scene.change("colliders:", kSecond);
  scene.change("position: [0, 2, 0]", "position: [0, 1.2, 0]");
  const Outcome outcome = run("simulate", scene);
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("bodies 'ball' and 'late' are, when one appears at 0.125 s, "));
  EXPECT_THAT(outcome.err, HasSubstr(" m inside each other"));
}

TEST(Spawn, WrongTimesAreTold) {
  TinyScene scene;
  scene.change("    mesh: ball.obj\n",
               "    spawn_s: 2\n    handles: [{region: {min: [0, 0, 0], max: [1, 0.2, 1]}, until_s: 1.5}]\n"
               "    mesh: ball.obj\n");
  EXPECT_THAT(vivify({"check", scene.file().string()}).err,
              HasSubstr("tiny.yaml:8:69: error: bodies[0].handles[0].until_s = 1.5 s is not after the body "
                        "appears, at 2 s"));
  scene.change("until_s: 1.5", "until_s: 3, motion: [{t_s: 1}, {t_s: 3, move: [0.1, 0, 0]}]");
  EXPECT_THAT(vivify({"check", scene.file().string()}).err,
              HasSubstr("bodies[0].handles[0].motion does not begin where the body is"));
  scene.change("{t_s: 1}", "{t_s: 2}");
  const Outcome late = vivify({"check", scene.file().string()});
  EXPECT_EQ(late.code, 0);
  EXPECT_THAT(late.err,
              HasSubstr("tiny.yaml:7:14: warning: bodies[0].spawn_s = 2 s is after the last frame"));
  scene.change("spawn_s: 2", "spawn_s: -1");
  const Outcome negative = vivify({"check", scene.file().string()});
  EXPECT_EQ(negative.code, 2);
  EXPECT_THAT(negative.err, HasSubstr("bodies[0].spawn_s = -1 s must be >= 0"));
}

}  // namespace
}  // namespace vivify::pipeline
