// Scenes with several bodies as they are shipped: the cups use contact, and every body obeys its equations of
// motion while they do.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/pipeline/scene_run.h"

namespace vivify::pipeline {
namespace {

using testing_support::SceneRun;

constexpr double kCupHeight = 0.9;  // m

TEST(CompanyScenes, ACupHopsOverSoftObstacles) {
  const SceneRun run("obstacles.yaml");
  EXPECT_LE(run.steps().largest("residual_rel"), 1e-8);
  EXPECT_GT(run.at("cup", "com_x_m", 0) - run.at("cup", "com_x_m", 1), 2);
  EXPECT_LE(run.most("cup", "tilt_deg"), 45);
  EXPECT_LE(run.most("cup", "max_penetration_m"), 0.01 * kCupHeight);
  int trodden_on = 0;
  for (const std::string ball : {"ball1", "ball2", "ball3"}) {
    trodden_on += run.least(ball, "min_element_ratio") < 0.8;
    EXPECT_GT(run.least(ball, "min_element_ratio"), 0) << "no element turned inside out";
    EXPECT_NEAR(run.at(ball, "com_y_m", 1), 0.06, 0.01) << "it lies on the table again";
  }
  EXPECT_GE(trodden_on, 2);
}

TEST(CompanyScenes, TwoCupsShoveEachOther) {
  const SceneRun run("shove.yaml");
  EXPECT_LE(run.steps().largest("residual_rel"), 1e-8);
  double nearest = INFINITY;
  for (double share = 0; share <= 1; share += 0.01) {
    const double way = run.at("right", "com_x_m", share) - run.at("left", "com_x_m", share);
    EXPECT_GT(way, 0) << "neither passes through the other";
    nearest = std::min(nearest, way);
  }
  EXPECT_LT(nearest, 1) << "they met";
  for (const std::string cup : {"left", "right"}) {
    EXPECT_LE(run.most(cup, "tilt_deg"), 45);
    EXPECT_LE(run.most(cup, "max_penetration_m"), 0.01 * kCupHeight);
    EXPECT_LE(run.most(cup, "internal_force_sum_n"), 1e-9 * 100);
  }
}

TEST(CompanyScenes, ACupIsLiftedByItsEarWhenABallDropsIn) {
  const SceneRun run("handles.yaml");
  EXPECT_LE(run.steps().largest("residual_rel"), 1e-8);
  EXPECT_GT(run.most("cup", "com_y_m") - run.at("cup", "com_y_m", 0), 0.5);
  EXPECT_GT(run.least("cup", "min_element_ratio"), 0) << "no element turned inside out";
  EXPECT_EQ(run.at("cup", "handle_force_y_n", 1), 0) << "it was let go";
  EXPECT_NEAR(run.at("cup", "com_y_m", 1), run.at("cup", "com_y_m", 0), 0.01 * kCupHeight);
  EXPECT_LE(run.at("cup", "tilt_deg", 1), 1);

  // In the air only its weight and the handle change the momentum of the cup: in every step they tell the
  // same mass.
  const std::vector<std::size_t>& rows = run.rows("cup");
  const testing_support::Steps& steps = run.steps();
  double least = INFINITY, most = 0;
  int in_the_air = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const std::size_t before = rows[i - 1], now = rows[i];
    if (steps("contacts", before) > 0 || steps("contacts", now) > 0) continue;
    const double acceleration =
        (steps("vel_y_m_s", now) - steps("vel_y_m_s", before)) / (steps("t_s", now) - steps("t_s", before));
    const double mass = steps("handle_force_y_n", now) / (acceleration + 9.81);
    least = std::min(least, mass);
    most = std::max(most, mass);
    ++in_the_air;
  }
  EXPECT_GE(in_the_air, 48) << "a second";
  EXPECT_GT(least, 0);
  EXPECT_LE(most - least, 1e-6 * most);

  EXPECT_GT(run.at("ball", "t_s", 0), 1.5);
  EXPECT_GT(run.at("ball", "com_y_m", 0), 2);
  EXPECT_LT(run.least("ball", "min_element_ratio"), 0.9) << "it is soft";
  EXPECT_NEAR(run.at("ball", "com_y_m", 1), 0.21, 0.01) << "it lies on the table";
}

}  // namespace
}  // namespace vivify::pipeline
