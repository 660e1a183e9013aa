// What goes wrong outside the scene file: geometry, disks, folders, programs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "common/file.h"
#include "tests/common/temporary_folder.h"
#include "tests/pipeline/program.h"
#include "tests/pipeline/tiny_scene.h"

namespace vivify::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::ball_mesh;
using testing_support::box_mesh;
using testing_support::files_below;
using testing_support::obj_text;
using testing_support::Outcome;
using testing_support::ProgramOptions;
using testing_support::TinyScene;
using testing_support::vivify;

Outcome run(const TinyScene& scene, const std::string& command, const ProgramOptions& program = {},
            std::vector<std::string> options = {}) {
  std::vector<std::string> arguments = {command, scene.file().string(), "-o", scene.out().string(),
                                        "--progress=none"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  return vivify(arguments, program);
}

TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh mesh;
  mesh.V.resize(a.V.rows() + b.V.rows(), 3);
  mesh.V << a.V, b.V;
  mesh.F.resize(a.F.rows() + b.F.rows(), 3);
  mesh.F << a.F, (b.F.array() + static_cast<int>(a.V.rows())).matrix();
  return mesh;
}

TEST(WrongGeometry, EmptyMeshIsThree) {
  const TinyScene scene;
  scene.write("ball.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  const Outcome outcome = run(scene, "mesh");
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("tiny.yaml:7:11: error: ball: "));
  EXPECT_THAT(files_below(scene.out() / "mesh"), testing::IsEmpty());
}

TEST(WrongGeometry, VertexThatIsNoNumberIsThree) {
  const TinyScene scene;
  std::string text = obj_text(ball_mesh(0.5, 2));
  const std::size_t second = text.find('\n') + 1;
  text.replace(second, text.find('\n', second) - second, "v nan 0 0");
  scene.write("ball.obj", text);
  const Outcome outcome = run(scene, "mesh");
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("ball: "));
}

TEST(WrongGeometry, GarbageIsRefused) {
  const TinyScene scene;
  scene.write("ball.obj", std::string(1000, '\x01'));
  const Outcome outcome = run(scene, "mesh");
  EXPECT_TRUE(outcome.code == 3 || outcome.code == 5) << outcome.code << outcome.err;
}

TEST(WrongGeometry, OpenMeshIsRepairedWithANote) {
  const TinyScene scene;
  TriangleMesh open = ball_mesh(0.5, 2);
  open.F.conservativeResize(open.F.rows() - 3, 3);
  scene.write("ball.obj", obj_text(open));
  const Outcome outcome = run(scene, "mesh");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("hole"));
}

TEST(WrongGeometry, SelfIntersectingMeshIsRepairedWithANote) {
  const TinyScene scene;
  TriangleMesh bar = box_mesh({0.8, 0.2, 0.2});
  scene.write("ball.obj", obj_text(joined(ball_mesh(0.5, 2), bar)));
  const Outcome outcome = run(scene, "mesh");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("ball: "));
}

TEST(WrongGeometry, CageThatDoesNotEncloseIsThree) {
  TinyScene scene;
  scene.write("cage.obj", obj_text(box_mesh({0.4, 0.4, 0.4})));
  scene.change("vertices: 8", "file: cage.obj");
  const Outcome outcome = run(scene, "weights");
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("tiny.yaml:10:"));
  EXPECT_THAT(outcome.err, HasSubstr("cage.obj"));
  EXPECT_THAT(files_below(scene.out() / "weights"), testing::IsEmpty());
}

TEST(GoodGeometry, CageFromAFileIsPlacedLikeItsBody) {
  TinyScene scene;
  scene.write("cage.obj", obj_text(box_mesh({0.6, 0.6, 0.6})));
  scene.change("vertices: 8", "file: cage.obj");
  scene.change("position: [0, 0.5, 0]", "position: [3, 1, 0]\n    scale: 2\n    heading_deg: 30");
  const Outcome outcome = run(scene, "weights");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
}

TEST(WrongLooks, UnknownPartIsTwo) {
  TinyScene scene;
  scene.change("looks: {all: clay}", "looks: {handle: clay}");
  const Outcome outcome = run(scene, "mesh");
  EXPECT_EQ(outcome.code, 2) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("handle"));
}

TEST(WrongFolder, OutputThatCannotBeMadeIsFive) {
  const TinyScene scene;
  scene.write("file", "in the way");
  for (const std::string& out : {(scene.folder() / "file").string(), (scene.folder() / "file/out").string(),
                                 std::string("/proc/vivify")}) {
    const Outcome outcome = vivify({"run", scene.file().string(), "-o", out});
    EXPECT_EQ(outcome.code, 5) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(out));
  }
  EXPECT_EQ(read_text_file(scene.folder() / "file"), "in the way");
}

TEST(WrongProgram, NoFfmpegKeepsThePictures) {
  const TinyScene scene;
  ProgramOptions program;
  program.environment["PATH"] = scene.folder().string();
  const Outcome outcome = run(scene, "run", program);
  EXPECT_EQ(outcome.code, 5) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("ffmpeg"));
  EXPECT_FALSE(fs::exists(scene.out() / "tiny.mp4"));
  EXPECT_EQ(files_below(scene.out() / "render").size(), 6u);
  // With ffmpeg there again, only the video is made.
  const Outcome again = run(scene, "run");
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr("render: cached"));
}

TEST(WrongNumbers, SimulationThatCannotGoOnIsFour) {
  TinyScene scene;
  scene.change("stiffness: 30000", "stiffness: 1e30, volume_stiffness: 1e30");
  const Outcome outcome = run(scene, "simulate");
  EXPECT_EQ(outcome.code, 4) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("ball"));
  EXPECT_FALSE(fs::exists(scene.out() / "sim/steps.csv"));
}

// Asked for the impossible, a character tries; the run ends as any other, and says what was not reached and
// why.
struct Impossible {
  const char* name;
  std::string scene, body;
  std::vector<std::string> settings;
  std::vector<std::string> says;
};
void PrintTo(const Impossible& asked, std::ostream* out) { *out << asked.name; }

class ImpossibleTest : public testing::TestWithParam<Impossible> {};

TEST_P(ImpossibleTest, IsTriedAndTold) {
  const testing_support::TemporaryFolder folder;
  std::vector<std::string> arguments = {"simulate", VIVIFY_SOURCE_DIR "/configs/" + GetParam().scene, "-o",
                                        (folder / "out").string(), "--progress=none"};
  for (const std::string& setting : GetParam().settings)
    arguments.insert(arguments.end(), {"--set", setting});
  const Outcome outcome = vivify(arguments);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const auto summary = nlohmann::json::parse(read_text_file(folder / "out/sim/summary.json"));
  const auto& arrival = summary["bodies"][GetParam().body]["arrival"];
  EXPECT_EQ(arrival["arrived"], false) << summary;
  EXPECT_THAT(outcome.err, HasSubstr("warning: " + GetParam().body + ": did not arrive at ["));
  for (const std::string& part : GetParam().says) {
    EXPECT_THAT(arrival["reasons"].dump(), HasSubstr(part));
    EXPECT_THAT(outcome.err, HasSubstr(part));
  }
}

std::vector<std::string> sent_to(const std::string& place, std::vector<std::string> more = {}) {
  more.insert(more.end(), {"frames.duration_s=2.5", "bodies.cup.controller.heading_deg=null",
                           "bodies.cup.controller.to=" + place});
  return more;
}

INSTANTIATE_TEST_SUITE_P(
    Asked, ImpossibleTest,
    testing::Values(Impossible{"too_soft",
                               "teacup.yaml",
                               "cup",
                               sent_to("[1, 0, 0]", {"bodies.cup.model.stiffness=8000",
                                                     "bodies.cup.model.volume_stiffness=8000"}),
                               {"too soft to hold it up", "it never left the ground"}},
                    Impossible{"no_friction",
                               "teacup.yaml",
                               "cup",
                               sent_to("[1, 0, 0]", {"colliders.table.friction=0"}),
                               {"the ground gave it no hold", "as without friction"}},
                    Impossible{
                        "in_the_air", "teacup.yaml", "cup", sent_to("[0.6, 3, 0]"), {"above its head"}},
                    Impossible{"too_far",
                               "teacup.yaml",
                               "cup",
                               sent_to("[6, 0, 0]"),
                               {"the clip ended while it was on its way"}},
                    Impossible{"walker_on_ice",
                               "castle_solid.yaml",
                               "castle",
                               {"colliders.table.friction=0"},
                               {"the ground gave it no hold"}}),
    [](const auto& tested) { return tested.param.name; });

TEST(Possible, IsToldInTheSummaryAlone) {
  const testing_support::TemporaryFolder folder;
  const Outcome outcome = vivify({"simulate", VIVIFY_SOURCE_DIR "/configs/castle_solid.yaml", "-o",
                                  (folder / "out").string(), "--progress=none"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const auto summary = nlohmann::json::parse(read_text_file(folder / "out/sim/summary.json"));
  const auto& arrival = summary["bodies"]["castle"]["arrival"];
  EXPECT_EQ(arrival["arrived"], true) << summary;
  EXPECT_EQ(arrival["reasons"].size(), 0);
  EXPECT_LE(arrival["missing_m"], 0.2);
  EXPECT_THAT(outcome.err, testing::Not(HasSubstr("did not arrive")));
}

// A disk that is full in the middle of one file of each kind.
class ShortWrite : public testing::TestWithParam<const char*> {};

TEST_P(ShortWrite, LeavesNoPartOfAFile) {
  const TinyScene scene;
  ASSERT_EQ(run(scene, "run").code, 0);
  const fs::path victim = scene.out() / GetParam();
  const std::string whole = read_text_file(victim);
  fs::remove(victim);
  ProgramOptions program;
  program.largest_file = static_cast<long>(whole.size()) - 1;
  const Outcome outcome = run(scene, "run", program);
  EXPECT_EQ(outcome.code, 5) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr(GetParam()));
  EXPECT_FALSE(fs::exists(victim));
  for (const auto& [name, content] : files_below(scene.out())) {
    EXPECT_EQ(name.find(".tmp"), std::string::npos) << name;
    EXPECT_EQ(name.find(".part"), std::string::npos) << name;
  }
  const Outcome again = run(scene, "run");
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(read_text_file(victim), whole);
}

INSTANTIATE_TEST_SUITE_P(Kinds, ShortWrite,
                         testing::Values("scene.resolved.yaml", "mesh/ball.h5", "weights/ball.h5",
                                         "sim/frames/0003.h5", "sim/steps.csv", "render/tiny.0002.exr",
                                         "tiny.mp4"),
                         [](const auto& parameter) {
                           std::string name = parameter.param;
                           for (char& c : name)
                             c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
                           return name;
                         });

TEST(ShortWriteOfSheet, LeavesNoPartOfAFile) {
  const TinyScene scene;
  ASSERT_EQ(run(scene, "render").code, 0);
  ProgramOptions program;
  program.largest_file = 500;
  EXPECT_EQ(vivify({"sheet", scene.out().string()}, program).code, 5);
  EXPECT_FALSE(fs::exists(scene.out() / "sheet.png"));
}

// run.json is written when everything else is there already, so that the limit meets no other file.
TEST(ShortWriteOfReports, EndsWithFive) {
  const TinyScene scene;
  ASSERT_EQ(run(scene, "mesh").code, 0);
  ASSERT_EQ(run(scene, "mesh").code, 0);  // now it says `cached`, as it will below
  const fs::path victim = scene.out() / "run.json";
  ProgramOptions program;
  program.largest_file = static_cast<long>(fs::file_size(victim)) - 1;
  fs::remove(victim);
  const Outcome outcome = run(scene, "mesh", program);
  EXPECT_EQ(outcome.code, 5) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("run.json"));
  EXPECT_FALSE(fs::exists(victim));
}

}  // namespace
}  // namespace vivify::pipeline
