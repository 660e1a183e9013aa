// The scenes of Table 1 that are quick to simulate: every character does what its scene says.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/pipeline/cast.h"

namespace vivify::pipeline {
namespace {

using testing_support::expect_laws;
using testing_support::flights_of;
using testing_support::SceneRun;

double level_distance(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::hypot(a.x() - b.x(), a.z() - b.z());
}

TEST(Cast, TheSphereRollsAlongACurveAndUpARamp) {
  constexpr double kDiameter = 0.6;
  const SceneRun run("sphere.yaml");
  expect_laws(run, {.body = "sphere", .height = kDiameter, .most_tilt_deg = 360});
  const std::vector<std::size_t>& rows = run.rows("sphere");
  for (const Eigen::Vector3d& place : {Eigen::Vector3d(0.4, 0, -2.2), Eigen::Vector3d(-0.5, 0, -1)}) {
    double nearest = INFINITY;
    for (const std::size_t row : rows) nearest = std::min(nearest, level_distance(run.centre(row), place));
    EXPECT_LE(nearest, 0.5 * kDiameter) << "it looks ahead, and rounds the corner";
  }
  double way = 0;
  for (std::size_t i = 1; i < rows.size(); ++i)
    way += level_distance(run.centre(rows[i]), run.centre(rows[i - 1]));
  EXPECT_GE(way, 5 * kDiameter);
  const Eigen::Vector3d end = run.centre(rows.back());
  EXPECT_LE(level_distance(end, {0, 0, 2}), 0.2 * kDiameter);
  EXPECT_NEAR(end.y() - run.centre(rows.front()).y(), 2 * std::tan(10 * std::numbers::pi / 180), 0.08)
      << "up the ramp";
  EXPECT_LE(run.velocity(rows.back()).norm(), 0.1) << "and it stays there";
}

TEST(Cast, ThreeCupsHopInCompanyEachInItsRhythm) {
  const SceneRun run("tea_cups.yaml");
  expect_laws(run, {.body = "cup", .height = 0.9});
  expect_laws(run, {.body = "mug", .height = 1.24});
  expect_laws(run, {.body = "espresso", .height = 0.66});
  struct Way {
    std::string cup;
    Eigen::Vector3d end;
    double width;
  };
  for (const auto& [cup, end, width] : {Way{"cup", {-1.1, 0, 0.2}, 1.2}, Way{"mug", {0.5, 0, -1.3}, 1.2},
                                        Way{"espresso", {-2, 0, 1.7}, 1.0}}) {
    EXPECT_LE(level_distance(run.centre(run.rows(cup).back()), end), 0.2 * width) << cup;
    EXPECT_GE(flights_of(run, cup), 4) << cup;
  }
  EXPECT_GT(flights_of(run, "espresso"), flights_of(run, "mug"));
}

// How far a body has turned about the vertical from one frame to another, by its widest line at the first.
double turn_deg(const SceneRun& run, const std::string& body, int from, int to) {
  const Eigen::MatrixXd a = run.vertices(body, from), b = run.vertices(body, to);
  Eigen::Index left = 0, right = 0;
  a.col(0).minCoeff(&left);
  a.col(0).maxCoeff(&right);
  const Eigen::RowVector3d before = a.row(right) - a.row(left), after = b.row(right) - b.row(left);
  return std::atan2(before.z() * after.x() - before.x() * after.z(),
                    before.x() * after.x() + before.z() * after.z()) *
         180 / std::numbers::pi;
}

TEST(Cast, AceHopsAlongOnItsCornersAndTurnsInTheAir) {
  const SceneRun run("ace_cage.yaml");
  expect_laws(run, {.body = "ace", .height = 1});
  const std::vector<std::size_t>& rows = run.rows("ace");
  EXPECT_NEAR(run.vertices("ace", 1).size(), 231, 23);
  EXPECT_GE(flights_of(run, "ace"), 7) << "six along, one for the trick";
  EXPECT_GE(run.centre(rows.front()).x() - run.centre(rows[rows.size() * 2 / 3]).x(), 0.7) << "its width";
  EXPECT_NEAR(turn_deg(run, "ace", 1, 100), 0, 5) << "facing us on the way";
  EXPECT_NEAR(std::abs(turn_deg(run, "ace", 100, 168)), 180, 30) << "half a turn";
  EXPECT_LE(run.velocity(rows.back()).norm(), 0.1) << "and it stands";
  EXPECT_LE(run.at("ace", "tilt_deg", 1), 5);
}

TEST(Cast, AceOfExamplesHopsAndTurnsAThirdRound) {
  const SceneRun run("ace_examples.yaml");
  expect_laws(run, {.body = "ace", .height = 1, .most_tilt_deg = 15});
  const std::vector<std::size_t>& rows = run.rows("ace");
  int hops = 0;  // they are too low for flights of a tenth of a second
  for (std::size_t i = 2; i < rows.size(); ++i)
    hops += run.steps()("contacts", rows[i]) == 0 && run.steps()("contacts", rows[i - 1]) == 0 &&
            run.steps()("contacts", rows[i - 2]) != 0;
  EXPECT_GE(hops, 7) << "six along, one for the trick";
  EXPECT_GE(std::abs(turn_deg(run, "ace", 1, 168)), 90);
  EXPECT_LE(run.velocity(rows.back()).norm(), 0.1) << "and it stands";
}

}  // namespace
}  // namespace vivify::pipeline
