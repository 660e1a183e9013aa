// `vivify pose`: example poses from handles.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/file.h"
#include "common/hdf5_file.h"
#include "common/mesh_io.h"
#include "tests/pipeline/program.h"
#include "tests/pipeline/tiny_scene.h"

namespace vivify::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::Outcome;
using testing_support::TinyScene;
using testing_support::vivify;

constexpr const char* kSquash = R"(version: 1
scene: tiny.yaml
body: ball
handles:
  - {region: {min: [0, 0, 0], max: [1, 0.25, 1]}, pin: true}
  - {region: {min: [0, 0.75, 0], max: [1, 1, 1]}, move: [0, -0.1, 0], rotate_deg: 30}
)";

class PoseCommandTest : public testing::Test {
 protected:
  Outcome pose(const std::string& text, std::vector<std::string> options = {}) {
    scene.write("squash.yaml", text);
    options.insert(options.begin(), {"pose", (scene.folder() / "squash.yaml").string()});
    return vivify(options);
  }
  RowMatrixXd rest() {
    const Outcome outcome =
        vivify({"mesh", scene.file().string(), "-o", scene.out().string(), "--progress=none"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return Hdf5Reader(scene.out() / "mesh/ball.h5").matrix("/X0");
  }
  TinyScene scene;
};

TEST_F(PoseCommandTest, WritesThePosedSimulationMesh) {
  const Outcome outcome = pose(kSquash);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const fs::path file = scene.folder() / "squash.ply";
  EXPECT_EQ(outcome.out, file.string() + "\n");
  EXPECT_THAT(outcome.err, HasSubstr("ball: 2 handles hold"));
  EXPECT_THAT(outcome.err, HasSubstr("increments"));

  const RowMatrixXd X = rest();
  const Points posed = read_ply_vertices(file);  // in the coordinates of the asset
  ASSERT_EQ(posed.rows(), X.rows());
  const Eigen::RowVector3d position(0, 0.5, 0);
  int pinned = 0, moved = 0;
  for (Eigen::Index i = 0; i < X.rows(); ++i) {
    const Eigen::RowVector3d change = posed.row(i) + position - X.row(i);
    if (X(i, 1) < 0.2) pinned += change.norm() <= 1e-12;
    if (X(i, 1) > 0.8) moved += std::abs(change.y() + 0.1) <= 1e-12;
  }
  EXPECT_GE(pinned, 3);
  EXPECT_GE(moved, 3);
  EXPECT_GE(read_mesh(file).F.rows(), 20);  // it can be looked at

  const std::string bytes = read_text_file(file);
  ASSERT_EQ(pose(kSquash, {"-o", (scene.folder() / "again.ply").string(), "-q"}).out, "");
  EXPECT_EQ(read_text_file(scene.folder() / "again.ply"), bytes);
}

// An example from the file that the command wrote, and one from the pose file itself.
TEST_F(PoseCommandTest, MakesExamples) {
  scene.change("position: [0, 0.5, 0]", "position: [0.5, 0.25, -1]\n    heading_deg: 40\n    scale: 0.5");
  ASSERT_EQ(pose(kSquash).code, 0);
  scene.change("rest_space: {type: cage, vertices: 8, harmonic_unknowns: 500}",
               "rest_space: {type: examples, examples: [{file: squash.ply}, {pose: squash.yaml}]}");
  const Outcome outcome = vivify(
      {"simulate", scene.file().string(), "-o", scene.out().string(), "--frames", "1-2", "--progress=none"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Hdf5Reader weights(scene.out() / "weights/ball.h5");
  const RowMatrixXd from_file = weights.matrix("/examples/0/V"), from_pose = weights.matrix("/examples/1/V");
  EXPECT_LE((from_file - from_pose).cwiseAbs().maxCoeff(), 1e-12);
}

struct WrongPose {
  const char* name;
  const char* text;
  const char* replacement;
  int code;
  std::vector<std::string> says;
};
void PrintTo(const WrongPose& pose, std::ostream* out) { *out << pose.name; }

class WrongPoseTest : public PoseCommandTest, public testing::WithParamInterface<WrongPose> {};

TEST_P(WrongPoseTest, IsReportedWithItsPlace) {
  std::string text = kSquash;
  const std::size_t at = text.find(GetParam().text);
  ASSERT_NE(at, text.npos);
  const Outcome outcome = pose(text.replace(at, std::string(GetParam().text).size(), GetParam().replacement));
  EXPECT_EQ(outcome.code, GetParam().code) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  for (const std::string& part : GetParam().says) EXPECT_THAT(outcome.err, HasSubstr(part));
  EXPECT_FALSE(fs::exists(scene.folder() / "squash.ply"));
}

INSTANTIATE_TEST_SUITE_P(
    Poses, WrongPoseTest,
    testing::Values(
        WrongPose{"no_scene", "scene: tiny.yaml\n", "", 2, {"squash.yaml:", "scene is missing"}},
        WrongPose{"no_such_scene", "tiny.yaml", "tony.yaml", 5, {"tony.yaml"}},
        WrongPose{"no_such_body", "body: ball", "body: bell", 2, {"squash.yaml:3:", "bell", "ball"}},
        WrongPose{"no_version", "version: 1\n", "", 2, {"version"}},
        WrongPose{"no_handles", "handles:", "handels:", 2, {":4:", "handels", "handles"}},
        WrongPose{"wrong_key", "pin: true", "pins: true", 2, {":5:", "pins", "pin"}},
        WrongPose{"no_region",
                  "region: {min: [0, 0, 0], max: [1, 0.25, 1]}, ",
                  "",
                  2,
                  {":5:", "handles[0].region"}},
        WrongPose{
            "pinned_and_moved", "pin: true", "pin: true, move: [1, 0, 0]", 2, {":5:", "handles[0].pin"}},
        WrongPose{"does_nothing", ", pin: true", "", 2, {":5:", "handles[0] does nothing"}},
        WrongPose{
            "empty_region", "min: [0, 0, 0]", "min: [0, 0.5, 0]", 2, {":5:", "handles[0].region is empty"}},
        WrongPose{
            "no_axis", "rotate_deg: 30", "rotate_deg: 30, axis: [0, 0, 0]", 2, {":6:", "handles[1].axis"}},
        WrongPose{"flat", "rotate_deg: 30", "scale: [1, 0, 1]", 2, {":6:", "handles[1].scale"}},
        WrongPose{"holds_nothing",
                  "min: [0, 0.75, 0], max: [1, 1, 1]",
                  "min: [2, 2, 2], max: [3, 3, 3]",
                  2,
                  {"squash.yaml:6:", "handles[1] takes hold of no vertex"}},
        WrongPose{"held_twice", "max: [1, 0.25, 1]", "max: [1, 1, 1]", 2, {"handles[0] and handles[1] both"}},
        WrongPose{"impossible",
                  "move: [0, -0.1, 0]",
                  "scale: [0.01, 30, 0.01], move: [0, -40, 0]",
                  4,
                  {"squash.yaml:5:", "% of their way"}}),
    [](const auto& parameter) { return parameter.param.name; });

}  // namespace
}  // namespace vivify::pipeline
