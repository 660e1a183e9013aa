// Commands that run no stage: options, exit codes, check, schema.
#include "pipeline/cli.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/file.h"
#include "tests/pipeline/program.h"
#include "tests/pipeline/tiny_scene.h"

namespace vivify::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::Outcome;
using testing_support::TinyScene;
using testing_support::vivify;

TEST(Cli, SaysItsVersion) {
  const Outcome outcome = vivify({"--version"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("vivify 0."));
}

TEST(Cli, HelpNamesEveryCommand) {
  const Outcome outcome = vivify({"--help"});
  EXPECT_EQ(outcome.code, 0);
  for (const char* command : {"run", "mesh", "weights", "simulate", "render", "encode", "check", "schema",
                              "pose", "sheet", "diff"}) {
    EXPECT_THAT(outcome.out, HasSubstr(command));
  }
}

TEST(Cli, WrongUsageIsTwo) {
  const TinyScene scene;
  const std::string file = scene.file().string(), out = scene.out().string();
  const std::vector<std::vector<std::string>> wrong = {
      {},
      {"fly"},
      {"run"},
      {"run", file, "--nonsense"},
      {"run", file, "--spp", "0"},
      {"run", file, "--spp", "many"},
      {"run", file, "--quality", "best"},
      {"run", file, "--size", "480"},
      {"run", file, "--size", "480x0", "-o", out},
      {"run", file, "--force=polish"},
      {"run", file, "-j", "0"},
      {"run", file, "--progress=loud"},
      {"run", file, "-v", "-q"},
      {"run", file, "--set", "nonsense", "-o", out},
      {"run", file, "--set", "frames.fps=zero", "-o", out},
      {"run", file, "--frames", "5-1", "-o", out},
      {"run", file, "--frames", "0", "-o", out},
      {"run", file, "--frames", "7", "-o", out},
      {"schema", "--json", "--markdown"},
      {"diff", file},
  };
  for (const std::vector<std::string>& arguments : wrong) {
    const Outcome outcome = vivify(arguments);
    EXPECT_EQ(outcome.code, 2) << testing::PrintToString(arguments) << outcome.err;
    EXPECT_FALSE(outcome.err.empty()) << testing::PrintToString(arguments);
  }
  EXPECT_FALSE(fs::exists(scene.out()));
}

TEST(Cli, ForceDoesNotSwallowTheScene) {
  const TinyScene scene;
  for (const std::string force : {"--force", "--force=render"}) {
    const Outcome outcome =
        vivify({"run", force, scene.file().string(), "-o", scene.out().string(), "--dry-run"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("render: 6 of 6 files to make"));
  }
}

TEST(Cli, DryRunMakesNothing) {
  const TinyScene scene;
  const Outcome outcome =
      vivify({"run", scene.file().string(), "-o", scene.out().string(), "--frames", "2-6x2", "--dry-run"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("mesh: 1 of 1 files to make: mesh/ball.h5"));
  EXPECT_THAT(outcome.out,
              HasSubstr("render: 3 of 3 files to make: render/tiny.0002.exr ... render/tiny.0006.exr"));
  EXPECT_FALSE(fs::exists(scene.out()));
}

TEST(Cli, LaterSettingsWin) {
  const TinyScene scene;
  const auto resolved = [&](std::vector<std::string> options) {
    const fs::path out = scene.out("resolved");
    fs::remove_all(out);
    std::vector<std::string> arguments = {"mesh", scene.file().string(), "-o", out.string(),
                                          "--progress=none"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = vivify(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return read_text_file(out / "scene.resolved.yaml");
  };
  EXPECT_THAT(resolved({}), HasSubstr("spp: 1\n"));
  EXPECT_THAT(resolved({"--quality", "draft"}), HasSubstr("spp: 4\n"));
  EXPECT_THAT(resolved({"--set", "render.spp=16", "--quality", "draft"}), HasSubstr("spp: 16\n"));
  EXPECT_THAT(resolved({"--spp", "2", "--set", "render.spp=16", "--set", "render.spp=32"}),
              HasSubstr("spp: 2\n"));
}

TEST(Check, AcceptsGoodScenes) {
  const TinyScene scene;
  const Outcome outcome = vivify({"check", scene.file().string(), scene.file().string()});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
}

TEST(Check, ShippedScenesAreGood) {
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(VIVIFY_SOURCE_DIR) / "configs")) {
    if (entry.path().extension() != ".yaml") continue;
    const Outcome outcome = vivify({"check", entry.path().string()});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
  }
}

// A change of the tiny scene, and what `check` says about it.
struct WrongScene {
  const char* name;
  const char* text;
  const char* replacement;
  std::vector<std::string> says;
};
void PrintTo(const WrongScene& scene, std::ostream* out) { *out << scene.name; }

class WrongSceneTest : public testing::TestWithParam<WrongScene> {};

TEST_P(WrongSceneTest, IsReportedWithItsPlace) {
  TinyScene scene;
  scene.change(GetParam().text, GetParam().replacement);
  const Outcome outcome = vivify({"check", scene.file().string()});
  EXPECT_EQ(outcome.code, 2) << outcome.err;
  for (const std::string& part : GetParam().says) EXPECT_THAT(outcome.err, HasSubstr(part));
  // One line per error, each beginning with the place.
  EXPECT_TRUE(outcome.err.starts_with(scene.file().string() + ":")) << outcome.err;
  // The commands refuse the scene in the same way, before anything is made.
  const Outcome run = vivify({"run", scene.file().string(), "-o", scene.out().string()});
  EXPECT_EQ(run.code, 2);
  EXPECT_EQ(run.err, outcome.err);
  EXPECT_FALSE(fs::exists(scene.out()));
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, WrongSceneTest,
    testing::Values(
        WrongScene{
            "missing_mesh",
            "mesh: ball.obj",
            "mesh: bull.obj",
            {":7:11: error: bodies[0].mesh = bull.obj: there is no file", "relative to the scene file"}},
        WrongScene{"missing_collider", "plate.obj", "plaet.obj", {":15:", "colliders[0].mesh = plaet.obj"}},
        WrongScene{"missing_cage", "vertices: 8", "file: none.obj", {":10:", "none.obj", "there is no file"}},
        WrongScene{"missing_texture",
                   "{type: environment}",
                   "{type: environment, file: sky.exr}",
                   {":18:", "lights[0].file = sky.exr"}},
        WrongScene{"negative_density",
                   "density: 100",
                   "density: -3",
                   {":11:", "error: bodies[0].model.density = -3 kg/m³ must be > 0"}},
        WrongScene{"unknown_key",
                   "mesh: ball.obj",
                   "mesh: ball.obj\n    positoin: [0, 0, 0]",
                   {":8:5: error: ", "positoin", "position"}},
        WrongScene{"unknown_look",
                   "looks: {all: clay}",
                   "looks: {all: caly}",
                   {":13:", "bodies[0].looks.all = caly: there is no such material", "did you mean 'clay'?"}},
        WrongScene{"unknown_follow",
                   "follow: ball",
                   "follow: bal",
                   {":16:", "camera.follow = bal: there is no such body", "did you mean 'ball'?"}},
        WrongScene{"same_name", "name: plate", "name: ball", {":15:", "is the name of bodies[0] already"}},
        WrongScene{"bad_name", "- name: ball", "- name: ../ball", {":6:", "letters, digits"}},
        WrongScene{"no_version", "version: 1\n", "", {"version"}},
        WrongScene{"other_version", "version: 1", "version: 2", {":1:10", "version"}},
        WrongScene{"duplicate_key", "follow: ball}", "follow: ball, target: [0, 0, 0]}", {":16:", "target"}},
        WrongScene{"octal", "fps: 24", "fps: 010", {":2:15", "010"}},
        WrongScene{"merge_key",
                   "model: {type: solid3d",
                   "model: {<<: {type: solid3d}, type: solid3d",
                   {":11:", "<<"}},
        WrongScene{"second_document", "bodies:", "---\nbodies:", {":5:"}},
        WrongScene{"self_reference", "lights:", "extra: &a [*a]\nlights:", {":17:"}},
        WrongScene{"syntax", "bodies:", "bodies: ]", {":5:"}},
        WrongScene{"wrong_type", "fps: 24", "fps: fast", {":2:15: error: frames.fps"}},
        WrongScene{"too_short", "duration_s: 0.25", "duration_s: 0.001", {":2:", "shorter than one frame"}},
        WrongScene{
            "broken_pixels", "size: [32, 18]", "size: [32.5, 18]", {":19:", "whole numbers of pixels"}},
        WrongScene{"no_controller", "type: hop", "type: hopp", {":12:", "hopp", "hop"}}),
    [](const auto& parameter) { return parameter.param.name; });

TEST(Check, ReportsAllErrorsAtOnce) {
  TinyScene scene;
  scene.change("fps: 24", "fps: -1");
  scene.change("density: 100", "density: -3");
  scene.change("type: hop,", "type: hop, heihgt: 1,");
  scene.change("spp: 1", "spp: 0");
  scene.change("mesh: ball.obj", "mesh: boll.obj");
  const Outcome outcome = vivify({"check", scene.file().string()});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 5) << outcome.err;
  EXPECT_LT(outcome.err.find("boll.obj"), outcome.err.find("density")) << "in the order of the file";
}

TEST(Check, ReportsAllFilesAtOnce) {
  TinyScene scene;
  scene.write("other.yaml", "version: 1\nbodis: []\n");
  scene.change("fps: 24", "fps: -1");
  const Outcome outcome = vivify({"check", scene.file().string(), (scene.folder() / "other.yaml").string()});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("tiny.yaml:2:"));
  EXPECT_THAT(outcome.err, HasSubstr("other.yaml:2:"));
  EXPECT_THAT(outcome.err, HasSubstr("bodies"));
}

TEST(Check, SceneThatCannotBeReadIsFive) {
  const TinyScene scene;
  EXPECT_EQ(vivify({"check", (scene.folder() / "nothing.yaml").string()}).code, 5);
  EXPECT_EQ(vivify({"run", (scene.folder() / "nothing.yaml").string()}).code, 5);
  EXPECT_EQ(vivify({"check", scene.folder().string()}).code, 5);
}

TEST(SchemaCommand, JsonIsASchemaOfTheWholeScene) {
  const Outcome outcome = vivify({"schema", "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const nlohmann::json schema = nlohmann::json::parse(outcome.out);
  EXPECT_THAT(schema.at("$schema").get<std::string>(), HasSubstr("2020-12"));
  for (const char* key :
       {"version", "frames", "bodies", "colliders", "props", "materials", "camera", "lights", "render"}) {
    EXPECT_TRUE(schema.at("properties").contains(key)) << key;
  }
}

TEST(SchemaCommand, ReferencePageIsUpToDate) {
  const Outcome outcome = vivify({"schema", "--markdown"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(read_text_file(fs::path(VIVIFY_SOURCE_DIR) / "docs/reference.md"), outcome.out)
      << "make it again: build/release/vivify schema --markdown > docs/reference.md";
}

}  // namespace
}  // namespace vivify::pipeline
