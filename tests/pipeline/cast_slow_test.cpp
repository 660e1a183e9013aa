// The scenes of Table 1 that take longer.
#include <gtest/gtest.h>

#include "tests/pipeline/cast.h"

namespace vivify::pipeline {
namespace {

using testing_support::expect_played;
using testing_support::SceneRun;

TEST(Cast, CheesyRunsFromTheGrapes) {
  const SceneRun run("cheesy.yaml");
  expect_played(run, "cheesy");
  for (int i = 1; i <= 6; ++i) {
    const std::string grape = "grape" + std::to_string(i);
    EXPECT_LE(run.most(grape, "residual_rel"), 1e-8);
    EXPECT_GT(run.least(grape, "min_element_ratio"), 0);
  }
}

TEST(Cast, TheCrossRunsOnItsGrowingArms) { expect_played(SceneRun("cross.yaml"), "cross"); }

TEST(Cast, TheLettersStandInTheirPlaces) { expect_played(SceneRun("letters.yaml"), "letters"); }

}  // namespace
}  // namespace vivify::pipeline
