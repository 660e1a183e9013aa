// Whole runs of the real executable on a tiny scene: caching, resuming, determinism, and what is written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/file.h"
#include "common/hdf5_file.h"
#include "tests/pipeline/program.h"
#include "tests/pipeline/tiny_scene.h"

namespace vivify::pipeline {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing_support::ball_mesh;
using testing_support::files_below;
using testing_support::obj_text;
using testing_support::Outcome;
using testing_support::ProgramOptions;
using testing_support::TinyScene;
using testing_support::vivify;
using Files = std::map<std::string, std::string>;

Outcome run(const TinyScene& scene, const fs::path& out, std::vector<std::string> options = {},
            const ProgramOptions& program = {}, const std::string& command = "run") {
  std::vector<std::string> arguments = {command, scene.file().string(), "-o", out.string(),
                                        "--progress=none"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  return vivify(arguments, program);
}

// The files whose bytes are promised: mesh, weights, sim, render.
Files promised_files(const fs::path& out) {
  Files files;
  for (const char* folder : {"mesh", "weights", "sim", "render"}) {
    for (auto& [name, content] : files_below(out / folder)) files[folder + ("/" + name)] = std::move(content);
  }
  return files;
}

// Names of the files that differ or are in one of the two only.
std::vector<std::string> differences(const Files& a, const Files& b) {
  std::vector<std::string> names;
  for (const auto& [name, content] : a) {
    if (!b.contains(name) || b.at(name) != content) names.push_back(name);
  }
  for (const auto& [name, content] : b) {
    if (!a.contains(name)) names.push_back(name);
  }
  return names;
}

json read_json(const fs::path& path) { return json::parse(read_text_file(path)); }

std::map<std::string, std::string> statuses(const fs::path& out) {
  std::map<std::string, std::string> result;
  const json run_json = read_json(out / "run.json");
  for (const auto& [stage, entry] : run_json.at("stages").items()) {
    result[stage] = entry.at("status");
  }
  return result;
}

std::map<std::string, fs::file_time_type> times_below(const fs::path& folder) {
  std::map<std::string, fs::file_time_type> times;
  for (const auto& [name, content] : files_below(folder)) times[name] = fs::last_write_time(folder / name);
  return times;
}

const std::map<std::string, std::string> kAllCached = {{"mesh", "cached"},
                                                       {"weights", "cached"},
                                                       {"simulate", "cached"},
                                                       {"render", "cached"},
                                                       {"encode", "cached"}};

TEST(Run, WritesWhatIsPromised) {
  const TinyScene scene;
  const fs::path out = scene.out();
  const Outcome outcome = run(scene, out);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, (out / "tiny.mp4").string() + "\n");
  for (const char* file : {"scene.resolved.yaml", "run.json", "timing.json", "mesh/ball.h5",
                           "weights/ball.h5", "sim/frames/0001.h5", "sim/frames/0006.h5", "sim/steps.csv",
                           "sim/summary.json", "render/tiny.0001.exr", "render/tiny.0006.exr", "tiny.mp4"}) {
    EXPECT_TRUE(fs::is_regular_file(out / file)) << file;
  }
  EXPECT_FALSE(fs::exists(out / "sim/frames/0007.h5"));

  const json run_json = read_json(out / "run.json");
  EXPECT_FALSE(run_json.at("processor").get<std::string>().empty());
  EXPECT_TRUE(run_json.at("libraries").contains("Eigen"));
  for (const char* stage : {"mesh", "weights", "simulate", "render", "encode"}) {
    EXPECT_EQ(run_json.at("stages").at(stage).at("status"), "ran");
    EXPECT_EQ(run_json.at("stages").at(stage).at("key").get<std::string>().size(), 32u);
  }
  const json timing = read_json(out / "timing.json");
  for (const char* stage : {"mesh", "weights", "simulate", "render", "encode"}) {
    EXPECT_GT(timing.at("stages").at(stage).at("wall_s"), 0);
    EXPECT_GT(timing.at("stages").at(stage).at("peak_mb"), 1);
  }
  EXPECT_NEAR(timing.at("bodies").at("ball").at("sim_seconds").get<double>(), 5.0 / 24, 1e-3);
  EXPECT_GT(timing.at("bodies").at("ball").at("wall_per_sim_second"), 0);
}

TEST(Run, SceneWithoutAnythingIsAVideoOfTheSky) {
  const TinyScene scene;
  write_file_atomic(
      scene.file(),
      std::string_view("version: 1\nframes: {duration_s: 0.1}\nrender: {size: [32, 18], spp: 1}\n"));
  const Outcome outcome = run(scene, scene.out());
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(fs::exists(scene.out() / "tiny.mp4"));
}

TEST(Run, StepsAndSummaryAgree) {
  const TinyScene scene;
  ASSERT_EQ(run(scene, scene.out(), {}, {}, "simulate").code, 0);
  std::istringstream csv(read_text_file(scene.out() / "sim/steps.csv"));
  std::string line;
  std::getline(csv, line);
  EXPECT_TRUE(
      line.starts_with("step,t_s,body,method,sqp_iterations,linesearch_halvings,fallback,residual_rel,"));
  int rows = 0;
  while (std::getline(csv, line)) {
    ++rows;
    EXPECT_TRUE(line.starts_with(std::to_string(rows) + ",")) << line;
  }
  EXPECT_EQ(rows, 10);  // five frames of two steps; frame 1 is the start
  const json body = read_json(scene.out() / "sim/summary.json").at("bodies").at("ball");
  EXPECT_EQ(body.at("steps"), 10);
  EXPECT_EQ(body.at("params"), 24);
  EXPECT_EQ(body.at("model"), "solid3d");
  EXPECT_EQ(body.at("space"), "cage");
  const Hdf5Reader mesh(scene.out() / "mesh/ball.h5");
  EXPECT_EQ(body.at("dofs"), 3 * mesh.matrix("/X0").rows());
  EXPECT_LE(body.at("max_residual_rel"), 1e-8);
  EXPECT_NEAR(Hdf5Reader(scene.out() / "sim/frames/0003.h5").scalar("/t"), 2.0 / 24, 1e-12);
}

TEST(Run, SecondRunDoesNothing) {
  const TinyScene scene;
  ASSERT_EQ(run(scene, scene.out()).code, 0);
  const auto before = times_below(scene.out() / "render");
  const fs::file_time_type video = fs::last_write_time(scene.out() / "tiny.mp4");
  const Outcome outcome = run(scene, scene.out());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(statuses(scene.out()), kAllCached);
  EXPECT_EQ(times_below(scene.out() / "render"), before);
  EXPECT_EQ(fs::last_write_time(scene.out() / "tiny.mp4"), video);
}

TEST(Run, EarlierStagesKeepWhatIsKnownOfLaterOnes) {
  TinyScene scene;
  ASSERT_EQ(run(scene, scene.out()).code, 0);
  ASSERT_EQ(run(scene, scene.out(), {}, {}, "mesh").code, 0);
  std::map<std::string, std::string> expected = {
      {"mesh", "cached"}, {"weights", "ran"}, {"simulate", "ran"}, {"render", "ran"}, {"encode", "ran"}};
  EXPECT_EQ(statuses(scene.out()), expected);
  // What does not hold any more is not told.
  scene.change("position: [0, 1, 4]", "position: [0, 1.5, 5]");
  ASSERT_EQ(run(scene, scene.out(), {}, {}, "mesh").code, 0);
  expected.erase("render");
  expected.erase("encode");
  expected["simulate"] = "ran";
  EXPECT_EQ(statuses(scene.out()), expected);
}

TEST(Run, FilesBehindAMeshFileCount) {
  const TinyScene scene;
  const std::string ball = obj_text(ball_mesh(0.5, 2));
  scene.write("ball.obj", "mtllib clay of mine.mtl\n" + ball);
  ASSERT_EQ(run(scene, scene.out(), {}, {}, "mesh").code, 0);
  ASSERT_EQ(run(scene, scene.out(), {}, {}, "mesh").code, 0);
  EXPECT_EQ(statuses(scene.out()).at("mesh"), "cached");
  scene.write("clay of mine.mtl", "newmtl clay\n");
  ASSERT_EQ(run(scene, scene.out(), {}, {}, "mesh").code, 0);
  EXPECT_EQ(statuses(scene.out()).at("mesh"), "ran");
}

TEST(Run, SheetShowsTheFramesOfTheLastRun) {
  const TinyScene scene;
  ASSERT_EQ(run(scene, scene.out()).code, 0);
  const auto sheet = [&] {
    const Outcome outcome = vivify({"sheet", scene.out().string(), "--columns", "6", "--width", "600"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return read_text_file(scene.out() / "sheet.png");
  };
  const std::string all = sheet();
  ASSERT_EQ(run(scene, scene.out(), {"--frames", "2-3"}).code, 0);
  EXPECT_EQ(read_json(scene.out() / "run.json").at("stages").at("render").at("frames"), "2-3");
  const std::string two = sheet();
  EXPECT_NE(two, all);
  for (const char* file : {"tiny.0001.exr", "tiny.0004.exr", "tiny.0005.exr", "tiny.0006.exr"})
    EXPECT_TRUE(fs::remove(scene.out() / "render" / file));
  EXPECT_EQ(sheet(), two);
  ASSERT_EQ(run(scene, scene.out(), {"--frames", "2-3", "--set", "video.exposure_stops=1"}).code, 0);
  EXPECT_NE(sheet(), two);
}

TEST(Run, CameraDoesNotSimulateAgain) {
  TinyScene scene;
  ASSERT_EQ(run(scene, scene.out()).code, 0);
  scene.change("position: [0, 1, 4]", "position: [0, 1.5, 5]");
  ASSERT_EQ(run(scene, scene.out()).code, 0);
  auto expected = kAllCached;
  expected["render"] = expected["encode"] = "ran";
  EXPECT_EQ(statuses(scene.out()), expected);
}

TEST(Run, SizeRendersAllAgain) {
  const TinyScene scene;
  ASSERT_EQ(run(scene, scene.out()).code, 0);
  ASSERT_EQ(run(scene, scene.out(), {"--size", "48x32"}).code, 0);
  auto expected = kAllCached;
  expected["render"] = expected["encode"] = "ran";
  EXPECT_EQ(statuses(scene.out()), expected);
}

TEST(Run, LongerSceneGoesOnWithTheSimulation) {
  TinyScene scene, longer;
  longer.change("duration_s: 0.25", "duration_s: 0.375");
  ASSERT_EQ(run(scene, scene.out(), {}, {}, "simulate").code, 0);
  ASSERT_EQ(run(longer, scene.out(), {}, {}, "simulate").code, 0);
  EXPECT_EQ(statuses(scene.out()).at("simulate"), "resumed");
  ASSERT_EQ(run(longer, longer.out(), {}, {}, "simulate").code, 0);
  EXPECT_THAT(differences(promised_files(scene.out()), promised_files(longer.out())), testing::IsEmpty());
}

TEST(Run, ChangedControllerLeavesNoFrameOfTheOldSimulation) {
  TinyScene scene;
  ASSERT_EQ(run(scene, scene.out(), {}, {}, "simulate").code, 0);
  scene.change("heading_deg: 90", "heading_deg: 0");
  ASSERT_EQ(run(scene, scene.out(), {"--frames", "1-3"}, {}, "simulate").code, 0);
  EXPECT_EQ(files_below(scene.out() / "sim/frames").size(), 3u);
}

TEST(Run, ForceMakesTheSameBytesAgain) {
  const TinyScene scene;
  ASSERT_EQ(run(scene, scene.out()).code, 0);
  const Files before = promised_files(scene.out());
  ASSERT_EQ(run(scene, scene.out(), {"--force=simulate"}).code, 0);
  auto expected = kAllCached;
  expected["simulate"] = "ran";
  EXPECT_EQ(statuses(scene.out()), expected);
  ASSERT_EQ(run(scene, scene.out(), {"--force"}).code, 0);
  for (const auto& [stage, status] : statuses(scene.out())) EXPECT_EQ(status, "ran") << stage;
  EXPECT_THAT(differences(promised_files(scene.out()), before), testing::IsEmpty());
}

TEST(Run, DamagedAndDeletedFilesAreMadeAgain) {
  const TinyScene scene;
  ASSERT_EQ(run(scene, scene.out()).code, 0);
  const Files before = promised_files(scene.out());
  fs::remove(scene.out() / "sim/frames/0003.h5");
  fs::resize_file(scene.out() / "render/tiny.0002.exr", 100);
  fs::remove(scene.out() / "sim/steps.csv");
  const Outcome outcome = run(scene, scene.out());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(statuses(scene.out()).at("simulate"), "resumed");
  EXPECT_EQ(statuses(scene.out()).at("render"), "resumed");
  EXPECT_EQ(statuses(scene.out()).at("mesh"), "cached");
  EXPECT_THAT(differences(promised_files(scene.out()), before), testing::IsEmpty());
}

TEST(Run, ThreadsDoNotChangeABit) {
  const TinyScene scene;
  ASSERT_EQ(run(scene, scene.out("one"), {"-j", "1"}).code, 0);
  ASSERT_EQ(run(scene, scene.out("two"), {"-j", "2"}).code, 0);
  EXPECT_THAT(differences(promised_files(scene.out("one")), promised_files(scene.out("two"))),
              testing::IsEmpty());
}

TEST(Run, OneFrameAloneIsTheSameAsInTheRange) {
  const TinyScene scene;
  ASSERT_EQ(run(scene, scene.out("range"), {}, {}, "render").code, 0);
  ASSERT_EQ(run(scene, scene.out("alone"), {"--frames", "4"}, {}, "render").code, 0);
  EXPECT_EQ(files_below(scene.out("alone") / "render").size(), 1u);
  EXPECT_EQ(read_text_file(scene.out("alone") / "render/tiny.0004.exr"),
            read_text_file(scene.out("range") / "render/tiny.0004.exr"));
}

TEST(Run, SettingsOnTheCommandLineReachTheSimulation) {
  const TinyScene scene;
  ASSERT_EQ(run(scene, scene.out("x"), {}, {}, "simulate").code, 0);
  ASSERT_EQ(
      run(scene, scene.out("z"), {"--set", "bodies.ball.controller.heading_deg=0"}, {}, "simulate").code, 0);
  EXPECT_EQ(statuses(scene.out("z")).at("simulate"), "ran");
  EXPECT_NE(read_text_file(scene.out("x") / "sim/steps.csv"),
            read_text_file(scene.out("z") / "sim/steps.csv"));
}

TEST(Run, JsonProgressIsJsonAndEndsWhole) {
  const TinyScene scene;
  const Outcome outcome =
      vivify({"run", scene.file().string(), "-o", scene.out().string(), "--progress=json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  std::istringstream lines(outcome.out);
  std::vector<std::string> finished;
  long done = 0, total = 0;
  for (std::string line; std::getline(lines, line);) {
    const json event = json::parse(line);
    done = event.at("done");
    total = event.at("total");
    if (event.at("event") == "finish") {
      finished.push_back(event.at("stage"));
      EXPECT_EQ(done, total) << line;
    }
  }
  EXPECT_THAT(finished, testing::ElementsAre("mesh", "weights", "simulate", "render", "encode"));
}

TEST(Run, SecondRunInTheSameFolderIsRefused) {
  const TinyScene scene;
  ASSERT_EQ(run(scene, scene.out(), {}, {}, "mesh").code, 0);
  const int fd = ::open((scene.out() / ".cache/lock").c_str(), O_RDWR);
  ASSERT_GE(fd, 0);
  ASSERT_EQ(::flock(fd, LOCK_EX), 0);
  const Outcome outcome = run(scene, scene.out());
  ::close(fd);
  EXPECT_EQ(outcome.code, 5);
  EXPECT_THAT(outcome.err, HasSubstr("another vivify is working in"));
}

TEST(Run, SheetAndDiffWorkOnItsPictures) {
  const TinyScene scene;
  ASSERT_EQ(run(scene, scene.out("a"), {}, {}, "render").code, 0);
  ASSERT_EQ(run(scene, scene.out("b"), {"--set", "render.seed=1"}, {}, "render").code, 0);
  EXPECT_EQ(vivify({"sheet", scene.out("a").string()}).code, 0);
  EXPECT_GT(fs::file_size(scene.out("a") / "sheet.png"), 100u);
  const auto diff = [&](const char* a, const char* b) {
    return vivify({"diff", "--exact", (scene.out(a) / "render").string(), (scene.out(b) / "render").string()})
        .code;
  };
  EXPECT_EQ(diff("a", "a"), 0);
  EXPECT_EQ(diff("a", "b"), 1);
}

// Interrupts a run as soon as `marker` exists, and runs it again.
struct Interruption {
  const char* name;
  const char* marker;
  int signal;
  int code;
};

// The names of the tests show it; without this they would show addresses.
void PrintTo(const Interruption& interruption, std::ostream* out) { *out << interruption.name; }

class InterruptedRun : public testing::TestWithParam<Interruption> {};

TEST_P(InterruptedRun, EndsWithTheSameBytes) {
  TinyScene scene;
  scene.change("duration_s: 0.25", "duration_s: 0.5");
  scene.change("size: [32, 18], spp: 1", "size: [160, 90], spp: 8");
  ProgramOptions program;
  program.signal = GetParam().signal;
  program.interrupt_when = [&] { return fs::exists(scene.out() / GetParam().marker); };
  const Outcome interrupted = run(scene, scene.out(), {}, program);
  ASSERT_EQ(interrupted.code, GetParam().code) << interrupted.err;
  if (GetParam().code == 75) {
    EXPECT_THAT(interrupted.err, HasSubstr("run the same command again"));
  }
  EXPECT_FALSE(fs::exists(scene.out() / "tiny.mp4"));

  const Outcome resumed = run(scene, scene.out());
  ASSERT_EQ(resumed.code, 0) << resumed.err;
  ASSERT_EQ(run(scene, scene.out("straight")).code, 0);
  EXPECT_THAT(differences(promised_files(scene.out()), promised_files(scene.out("straight"))),
              testing::IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(
    Stages, InterruptedRun,
    testing::Values(Interruption{"killed_in_weights", "mesh/ball.h5", SIGKILL, 128 + SIGKILL},
                    Interruption{"killed_in_simulate", "sim/frames/0004.h5", SIGKILL, 128 + SIGKILL},
                    Interruption{"killed_in_render", "render/tiny.0003.exr", SIGKILL, 128 + SIGKILL},
                    Interruption{"stopped_in_simulate", "sim/frames/0004.h5", SIGTERM, 75},
                    Interruption{"stopped_in_render", "render/tiny.0003.exr", SIGTERM, 75},
                    Interruption{"time_limit_in_render", "render/tiny.0003.exr", SIGUSR1, 75},
                    Interruption{"ctrl_c_in_render", "render/tiny.0003.exr", SIGINT, 130}),
    [](const auto& parameter) { return parameter.param.name; });

// A flat body with example poses and several steps per frame, killed or stopped again and again.
TEST(Run, SimulationInterruptedManyTimesEndsWithTheSameBytes) {
  const TinyScene place;
  const auto simulate = [&](const char* out, const ProgramOptions& program = {}) {
    return vivify({"simulate", std::string(VIVIFY_SOURCE_DIR) + "/configs/figure3_bent.yaml", "-o",
                   place.out(out).string(), "--set", "frames.duration_s=1.5", "--progress=none"},
                  program);
  };
  ASSERT_EQ(simulate("straight").code, 0);
  const auto frames = [&] {
    int count = 0;
    const auto name = [&] { return (count < 9 ? "000" : "00") + std::to_string(count + 1) + ".h5"; };
    while (fs::exists(place.out("broken") / "sim" / "frames" / name())) ++count;
    return count;
  };
  int interrupted = 0;
  for (int run = 0; run < 6; ++run) {
    ProgramOptions program;
    program.signal = run % 2 == 0 ? SIGKILL : SIGTERM;
    program.interrupt_when = [&, enough = frames() + 1 + run] { return frames() >= enough; };
    const Outcome outcome = simulate("broken", program);
    interrupted += outcome.code == (program.signal == SIGKILL ? 128 + SIGKILL : 75);
  }
  EXPECT_GE(interrupted, 3);
  ASSERT_EQ(simulate("broken").code, 0);
  EXPECT_THAT(differences(promised_files(place.out("broken")), promised_files(place.out("straight"))),
              testing::IsEmpty());
  EXPECT_GE(promised_files(place.out("broken")).size(), 36u);
}

}  // namespace
}  // namespace vivify::pipeline
