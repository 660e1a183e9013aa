// Handles of bodies from the scene file to the simulation, and what is wrong with them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/file.h"
#include "common/hdf5_file.h"
#include "tests/pipeline/program.h"
#include "tests/pipeline/simulated_run.h"
#include "tests/pipeline/tiny_scene.h"

namespace vivify::pipeline {
namespace {

using testing::HasSubstr;
using testing_support::Outcome;
using testing_support::Steps;
using testing_support::TinyScene;
using testing_support::vivify;

constexpr const char* kTop = "region: {min: [0, 0.8, 0], max: [1, 1, 1]}";

// The tiny scene with a passive ball and handles, in line 7.
struct HeldBall : TinyScene {
  explicit HeldBall(const std::string& handles) {
    change("    mesh: ball.obj\n", "    handles: [" + handles + "]\n    mesh: ball.obj\n");
    change("{type: hop, heading_deg: 90}", "{type: rest}");
  }
};

Outcome simulate(const TinyScene& scene) {
  return vivify({"simulate", scene.file().string(), "-o", scene.out().string(), "--progress=none"});
}

struct WrongHandle {
  const char* name;
  std::string handles;  // where TOP stands for a region
  std::vector<std::string> says;
};

void PrintTo(const WrongHandle& c, std::ostream* stream) { *stream << c.name; }

std::string expanded(std::string handles) {
  for (std::size_t at; (at = handles.find("TOP")) != handles.npos;) handles.replace(at, 3, kTop);
  return handles;
}

class WrongHandleTest : public testing::TestWithParam<WrongHandle> {};

TEST_P(WrongHandleTest, IsReportedWithItsPlace) {
  const HeldBall scene(expanded(GetParam().handles));
  const Outcome outcome = vivify({"check", scene.file().string()});
  EXPECT_EQ(outcome.code, 2) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  for (const std::string& part : GetParam().says) EXPECT_THAT(outcome.err, HasSubstr(part));
}

INSTANTIATE_TEST_SUITE_P(
    Handles, WrongHandleTest,
    testing::Values(
        WrongHandle{"no_region", "{until_s: 1}", {"tiny.yaml:7:15:", "handles[0].region is missing"}},
        WrongHandle{"empty_region",
                    "{TOP}, {region: {min: [0, 1, 0], max: [1, 0, 1]}}",
                    {":7:70:", "bodies[0].handles[1].region is empty: min is above max"}},
        WrongHandle{"keys_at_the_same_time",
                    "{TOP, motion: [{t_s: 0}, {t_s: 1}, {t_s: 1, move: [1, 0, 0]}]}",
                    {":7:89:", "bodies[0].handles[0].motion[2].t_s = 1 s is not after the key before it",
                     "cannot jump"}},
        WrongHandle{"keys_too_far_apart",
                    "{TOP, motion: [{t_s: 0}, {t_s: 0.1, move: [0, 50, 0]}]}",
                    {":7:79:", "motion[1] jumps: 50 m from the key before it, 0.1 s earlier"}},
        WrongHandle{"begins_elsewhere",
                    "{TOP, motion: [{t_s: 1, rotation_deg: [0, 20, 0]}]}",
                    {":7:68:", "bodies[0].handles[0].motion does not begin where the body is"}},
        WrongHandle{"nothing_to_repeat",
                    "{TOP, repeat_motion: true}",
                    {":7:75:", "bodies[0].handles[0].repeat_motion does not fit: there is no motion"}},
        WrongHandle{"let_go_too_early",
                    "{TOP, until_s: -1}",
                    {":7:69:", "bodies[0].handles[0].until_s = -1 s is not after the body appears, at 0 s"}}),
    [](const auto& parameter) { return parameter.param.name; });

TEST(Handles, OfThePlaneStayInIt) {
  HeldBall scene(std::string("{") + kTop +
                 ", motion: [{t_s: 0}, {t_s: 1, rotation_deg: [0, 30, 0]}, {t_s: 2, move: [0, 0, 1]}]}");
  scene.change("mesh: ball.obj", "outline: {type: polygon, points: [[-1, 0], [1, 0], [0, 1]]}");
  scene.change("tetrahedra: {backend: tetgen, vertices: 60}", "triangles: {vertices: 40}");
  scene.change("{type: solid3d, density: 100, stiffness: 30000}", "{type: solid2d}");
  const Outcome outcome = vivify({"check", scene.file().string()});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("handles[0].motion[1].rotation_deg turns out of the plane"));
  EXPECT_THAT(outcome.err, HasSubstr("handles[0].motion[2].move leads out of the plane"));
}

TEST(Handles, NeedDynamics) {
  HeldBall scene(std::string("{") + kTop + "}");
  scene.change("bodies:", "physics: static\nbodies:");
  const Outcome outcome = vivify({"check", scene.file().string()});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err,
              HasSubstr("tiny.yaml:8:14: error: bodies[0].handles does not fit: physics = static"));
}

// Only the mesh tells what a region holds.
TEST(Handles, ThatHoldNothingOrTheSameEndTheRun) {
  const auto failure = [](const std::string& handles) {
    const Outcome outcome = simulate(HeldBall(handles));
    EXPECT_EQ(outcome.code, 2);
    return outcome.err;
  };
  EXPECT_THAT(failure("{region: {min: [0, 0, 0], max: [0.05, 0.05, 0.05]}}"),
              HasSubstr("tiny.yaml:7:15: error: bodies[0].handles[0] takes hold of no vertex"));
  EXPECT_THAT(failure(std::string("{") + kTop + "}, {" + kTop + ", motion: [{t_s: 0}, {t_s: 1}]}"),
              HasSubstr("bodies[0].handles[0] and bodies[0].handles[1] both take hold of vertex"));
}

// The ball is lifted, turned and let go; its files are the same when it is simulated in two parts.
TEST(Handles, AreSimulated) {
  const HeldBall scene(std::string("{") + kTop +
                       ", motion: [{t_s: 0}, {t_s: 0.16, move: [0, 0.1, 0], rotation_deg: [0, 40, 0]}], "
                       "until_s: 0.167}");
  ASSERT_EQ(simulate(scene).code, 0);
  const RowMatrixXd X = Hdf5Reader(scene.out() / "mesh/ball.h5").matrix("/X0"),
                    x = Hdf5Reader(scene.out() / "sim/frames/0005.h5").matrix("/bodies/ball/x");
  Eigen::Index highest = 0;
  X.col(1).maxCoeff(&highest);
  EXPECT_NEAR(x(highest, 1) - X(highest, 1), 0.1, 1e-3);
  const Steps steps(scene.out() / "sim/steps.csv");
  ASSERT_EQ(steps.size(), 10u);
  EXPECT_GT(steps.largest("handle_force_y_n"), 0);
  EXPECT_NE(steps("handle_force_y_n", 7), 0) << "the step that ends at 1/6 s";
  EXPECT_EQ(steps("handle_force_y_n", 8), 0);

  const auto first_run = testing_support::files_below(scene.out() / "sim");
  std::filesystem::remove_all(scene.out() / "sim");
  ASSERT_EQ(vivify({"simulate", scene.file().string(), "-o", scene.out().string(), "--progress=none",
                    "--frames", "1-3"})
                .code,
            0);
  ASSERT_EQ(simulate(scene).code, 0);
  EXPECT_EQ(testing_support::files_below(scene.out() / "sim"), first_run);
}

TEST(Handles, AreSimulatedAgainWhenTheyChange) {
  HeldBall scene(std::string("{") + kTop + "}");
  const auto missing = [&] {
    const Outcome outcome =
        vivify({"simulate", scene.file().string(), "-o", scene.out().string(), "--dry-run"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.out.find("simulate: nothing to do") == outcome.out.npos;
  };
  ASSERT_EQ(simulate(scene).code, 0);
  EXPECT_FALSE(missing());
  scene.change("max: [1, 1, 1]}", "max: [1, 1, 1]}, until_s: 3");
  EXPECT_TRUE(missing());
}

}  // namespace
}  // namespace vivify::pipeline
