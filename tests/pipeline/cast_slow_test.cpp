// The scenes of Table 1 that take longer.
#include <gtest/gtest.h>

#include "tests/pipeline/cast.h"

namespace vivify::pipeline {
namespace {

using testing_support::expect_laws;
using testing_support::flights_of;
using testing_support::SceneRun;

TEST(Cast, CheesyRunsFromTheGrapes) {
  constexpr double kLength = 1.04;  // m
  const SceneRun run("cheesy.yaml");
  expect_laws(run, {.body = "cheesy", .height = 0.985});
  const std::vector<std::size_t>& rows = run.rows("cheesy");
  EXPECT_GE(run.centre(rows.front()).x() - run.centre(rows.back()).x(), 5 * kLength);
  EXPECT_GE(flights_of(run, "cheesy"), 8);
  for (int i = 1; i <= 6; ++i) {
    const std::string grape = "grape" + std::to_string(i);
    EXPECT_GE(run.at(grape, "com_x_m", 0) - run.at(grape, "com_x_m", 1), 5) << "it is after her";
    EXPECT_LE(run.most(grape, "residual_rel"), 1e-8);
    EXPECT_GT(run.least(grape, "min_element_ratio"), 0);
  }
}

TEST(Cast, TheCrossRunsOnItsGrowingArms) {
  constexpr double kHeight = 0.993;  // m
  const SceneRun run("cross.yaml");
  expect_laws(run, {.body = "cross", .height = kHeight});
  EXPECT_GE(run.at("cross", "com_x_m", 1) - run.at("cross", "com_x_m", 0), 6 * kHeight);
  EXPECT_GE(flights_of(run, "cross"), 10);
}

TEST(Cast, TheLettersStandInTheirPlaces) {
  const SceneRun run("letters.yaml");
  struct Letter {
    std::string name;
    double place, width;  // x of the centre of mass, and size; m
  };
  const std::vector<Letter> word = {{"S", -3.93, 0.79},  {"I", -3.11, 0.51}, {"G", -2.24, 0.97},
                                    {"G2", -1.11, 0.97}, {"R", 0.06, 1.08},  {"A", 1.38, 1.09},
                                    {"P", 2.48, 0.93},   {"H", 3.73, 1.17}};
  for (const auto& [name, place, width] : word) {
    expect_laws(run, {.body = name, .height = 1});
    EXPECT_GE(run.at(name, "com_x_m", 0), place + 9) << name << " comes from the right";
    EXPECT_GE(flights_of(run, name), 8) << name;
    const std::vector<std::size_t>& rows = run.rows(name);
    for (std::size_t i = rows.size() - rows.size() / 24; i < rows.size(); ++i)
      EXPECT_NEAR(run.centre(rows[i]).x(), place, 0.2 * width) << name << " stays in the last second";
  }
}

}  // namespace
}  // namespace vivify::pipeline
