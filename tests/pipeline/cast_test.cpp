// The scenes of Table 1: every character does what its scene says. Of those that take long
// (cast_slow_test.cpp) only the beginning: the first sets out, and all obey the laws.
#include <gtest/gtest.h>

#include "tests/pipeline/cast.h"
#include "tests/pipeline/sway_and_twist.h"

namespace vivify::pipeline {
namespace {

using testing_support::expect_laws;
using testing_support::expect_played;
using testing_support::Role;
using testing_support::roles_in;
using testing_support::SceneRun;
using testing_support::sway_deg;
using testing_support::twist_deg;

TEST(Cast, TheSphereRollsAlongACurveAndUpARamp) { expect_played(SceneRun("sphere.yaml"), "sphere"); }

TEST(Cast, ThreeCupsHopInCompanyEachInItsRhythm) { expect_played(SceneRun("tea_cups.yaml"), "tea_cups"); }

TEST(Cast, AceWalksOnItsCornersBowsAndTurnsInTheAir) {
  const SceneRun run("ace_cage.yaml");
  expect_played(run, "ace_cage");
  EXPECT_NEAR(run.vertices("ace", 1).size(), 231, 23);
  EXPECT_LE(run.at("ace", "tilt_deg", 1), 5);
}

TEST(Cast, AceOfExamplesWalksOnItsCornersBowsAndTurnsHalfRound) {
  const SceneRun run("ace_examples.yaml");
  expect_played(run, "ace_examples");
  EXPECT_LE(run.most("ace", "tilt_deg"), 20) << "of the bow";
}

// The light one is also asked to sway less; that it twists comes from its rest space.
TEST(Cast, OneCrustySwaysAndTheOtherTwistsToTheEndOfTheRace) {
  const SceneRun run("crusty_race.yaml");
  expect_played(run, "crusty_race");
  EXPECT_NEAR(run.vertices("dark", 1).size(), 114, 11);
  EXPECT_NEAR(run.vertices("light", 1).size(), 114, 11);
  EXPECT_GE(sway_deg(run, "dark"), 2 * sway_deg(run, "light"));
  EXPECT_GE(twist_deg(run, "light"), 2 * twist_deg(run, "dark"));
}

struct Beginning {
  const char* scene;
  const char* duration_s;
  const char* first;    // the body that sets out
  Eigen::Vector3d way;  // m, that it gets at least
};
void PrintTo(const Beginning& beginning, std::ostream* out) { *out << beginning.scene; }

class CastBeginning : public ::testing::TestWithParam<Beginning> {};
INSTANTIATE_TEST_SUITE_P(Long, CastBeginning,
                         ::testing::Values(Beginning{"cheesy", "1.5", "cheesy", {-0.8, 0, 0}},
                                           Beginning{"cross", "2", "cross", {0.7, 0, 0}},
                                           Beginning{"letters", "2", "S", {-1.5, 0, 0}}),
                         [](const auto& tested) { return std::string(tested.param.scene); });

TEST_P(CastBeginning, SetsOutByTheLaws) {
  const auto& [scene, duration_s, first, way] = GetParam();
  const SceneRun run(std::string(scene) + ".yaml", {"--set", std::string("frames.duration_s=") + duration_s});
  for (const Role& role : roles_in(scene)) {
    SCOPED_TRACE(role.body);
    expect_laws(run, role.body, role.height);
  }
  EXPECT_GE((run.end(first) - run.start(first)).dot(way), way.squaredNorm());
  EXPECT_LE(run.most(first, "tilt_deg"), 45);
}

}  // namespace
}  // namespace vivify::pipeline
