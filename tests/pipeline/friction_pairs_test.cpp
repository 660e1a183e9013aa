// Friction of pairs that the scene names, from the scene file to the motion.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "common/file.h"
#include "common/hdf5_file.h"
#include "tests/pipeline/program.h"
#include "tests/pipeline/tiny_scene.h"

namespace vivify::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::box_mesh;
using testing_support::obj_text;
using testing_support::Outcome;
using testing_support::TemporaryFolder;
using testing_support::vivify;

// A box that slides over a plate at 1 m/s with another one on top; then the friction at line 8.
class SlidingScene {
 public:
  explicit SlidingScene(const std::string& friction) {
    const std::string scene =
        R"(version: 1
frames: {fps: 24, duration_s: 0.25}
bodies:
  - {name: sled, mesh: box.obj, position: [0, 0.1, 0], velocity: [1, 0, 0], tetrahedra: {vertices: 30}, rest_space: {type: full}, contact: {friction: 0.5}}
  - {name: load, mesh: box.obj, position: [0, 0.301, 0], velocity: [1, 0, 0], tetrahedra: {vertices: 30}, rest_space: {type: full}, contact: {friction: 0.5}}
colliders:
  - {name: plate, mesh: plate.obj, position: [0, -0.1, 0], friction: 0.6}
)" + friction;
    write_file_atomic(file(), std::string_view(scene));
    write_file_atomic(folder_ / "box.obj", std::string_view(obj_text(box_mesh({0.3, 0.1, 0.3}))));
    write_file_atomic(folder_ / "plate.obj", std::string_view(obj_text(box_mesh({3, 0.1, 3}))));
  }
  fs::path file() const { return folder_ / "scene.yaml"; }
  Outcome check() const { return vivify({"check", file().string()}); }
  // The last frame.
  Hdf5Reader simulate() const {
    const Outcome outcome =
        vivify({"simulate", file().string(), "-o", (folder_ / "out").string(), "--progress=none", "-q"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return Hdf5Reader(folder_ / "out/sim/frames/0006.h5");
  }

 private:
  TemporaryFolder folder_;
};

double speed(const Hdf5Reader& frame, const std::string& body) {
  return frame.matrix("/bodies/" + body + "/v").col(0).mean();
}

TEST(FrictionPairs, ReplaceTheProductOfBothFactors) {
  const Hdf5Reader product = SlidingScene("").simulate();
  const Hdf5Reader same = SlidingScene("friction: [{between: [plate, sled], coefficient: 0.3}]\n").simulate();
  EXPECT_EQ(product.matrix("/bodies/sled/x"), same.matrix("/bodies/sled/x"));  // 0.5 · 0.6
  const Hdf5Reader ice = SlidingScene("friction: [{between: [sled, plate], coefficient: 0}]\n").simulate();
  EXPECT_NEAR(speed(ice, "sled"), 1, 0.01);
  EXPECT_NEAR(speed(ice, "load"), 1, 0.03);
  const Hdf5Reader held =
      SlidingScene("friction: [{between: [sled, plate], coefficient: .inf}]\n").simulate();
  EXPECT_LT(speed(held, "sled"), 0.2);
  EXPECT_LT(speed(product, "sled"), 0.7);
  EXPECT_GT(speed(product, "sled"), 0.2);
}

TEST(FrictionPairs, HoldBetweenBodiesToo) {
  // The sled stops; the load goes on over it, or stays on it.
  const std::string stop = "friction:\n  - {between: [sled, plate], coefficient: .inf}\n";
  const Hdf5Reader smooth = SlidingScene(stop + "  - {between: [load, sled], coefficient: 0}\n").simulate();
  EXPECT_GT(speed(smooth, "load"), 0.9);
  ASSERT_TRUE(smooth.has("/contacts"));
  EXPECT_EQ(smooth.matrix("/contacts/friction_force").cwiseAbs().maxCoeff(), 0);
  EXPECT_GT(smooth.vector("/contacts/slip").minCoeff(), 0);
  const Hdf5Reader rough = SlidingScene(stop + "  - {between: [sled, load], coefficient: 5}\n").simulate();
  EXPECT_LT(speed(rough, "load"), 0.7 * speed(smooth, "load"));
}

struct Wrong {
  const char* name;
  std::string friction;
  std::vector<std::string> says;
};
void PrintTo(const Wrong& c, std::ostream* stream) { *stream << c.name; }

class WrongFrictionTest : public testing::TestWithParam<Wrong> {};

TEST_P(WrongFrictionTest, IsReportedWithItsPlace) {
  const Outcome outcome = SlidingScene("friction: [" + GetParam().friction + "]\n").check();
  EXPECT_EQ(outcome.code, 2) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  for (const std::string& part : GetParam().says) EXPECT_THAT(outcome.err, HasSubstr(part));
}

INSTANTIATE_TEST_SUITE_P(
    Pairs, WrongFrictionTest,
    testing::Values(
        Wrong{"unknown",
              "{between: [sled, plat], coefficient: 1}",
              {"scene.yaml:8:29: error: friction[0].between: there is no body or collider 'plat'",
               "did you mean 'plate'?"}},
        Wrong{"one_name",
              "{between: [sled], coefficient: 1}",
              {":8:", "friction[0].between must have at least 2"}},
        Wrong{"three_names",
              "{between: [sled, load, plate], coefficient: 1}",
              {"scene.yaml:8:22: error: friction[0].between must have two names"}},
        Wrong{"colliders",
              "{between: [plate, plate], coefficient: 1}",
              {"scene.yaml:8:22:", "'plate' and 'plate' are colliders, which never touch each other"}},
        Wrong{"twice",
              "{between: [sled, load], coefficient: 1}, {between: [load, sled], coefficient: 2}",
              {"scene.yaml:8:63: error: friction[1].between: the pair is in friction[0] already"}},
        Wrong{"negative",
              "{between: [sled, load], coefficient: -1}",
              {":8:", "friction[0].coefficient = -1 must be >= 0"}},
        Wrong{"no_coefficient", "{between: [sled, load]}", {":8:", "friction[0].coefficient is missing"}}),
    [](const auto& parameter) { return std::string(parameter.param.name); });

TEST(FrictionPairs, MayBeOfABodyWithItself) {
  EXPECT_EQ(SlidingScene("friction: [{between: [sled, sled], coefficient: 0.2}]\n").check().code, 0);
}

}  // namespace
}  // namespace vivify::pipeline
