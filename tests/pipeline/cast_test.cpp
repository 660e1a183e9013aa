// The scenes of Table 1 that are quick to simulate: every character does what its scene says.
#include <gtest/gtest.h>

#include "tests/pipeline/cast.h"
#include "tests/pipeline/sway_and_twist.h"

namespace vivify::pipeline {
namespace {

using testing_support::expect_played;
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

}  // namespace
}  // namespace vivify::pipeline
