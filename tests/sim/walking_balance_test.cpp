// Where the ground shall push a walker, beside the motion of the linear inverted pendulum.
#include "sim/control/walking_balance.h"

#include <gtest/gtest.h>

#include <cmath>

namespace vivify::sim {
namespace {

constexpr double kPendulum = 4;  // ω, 1/s
constexpr double kSwing = 0.3;   // s

Support rectangle(double x, double half_width = 0.1) {
  return Support({{x - half_width, 0, -0.2},
                  {x + half_width, 0, -0.2},
                  {x + half_width, 0, 0.2},
                  {x - half_width, 0, 0.2}});
}
Support rectangles(double x, double z) {
  return Support({{x - 0.1, 0, -0.2}, {x - 0.1, 0, 0.2}, {z + 0.1, 0, -0.2}, {z + 0.1, 0, 0.2}});
}

// On a foot at x = `stays`, the other one on its way from there to `landing`, where it belongs.
Stance rocking(double stays, const Eigen::Vector3d& capture_point, const Eigen::Vector3d& belongs,
               const Eigen::Vector3d& landing) {
  return {Stance::swing,
          1,
          kPendulum,
          capture_point,
          rectangles(stays, belongs.x()),
          rectangle(stays),
          rectangle(stays),
          belongs,
          landing,
          kSwing,
          kSwing};
}

// The capture point after `duration`, pushed at p all the time.
Eigen::Vector3d fallen(const Eigen::Vector3d& capture_point, const Eigen::Vector3d& p, double duration) {
  Eigen::Vector3d at = capture_point;
  constexpr int kSteps = 10000;
  for (int i = 0; i < kSteps; ++i) {
    const Eigen::Vector3d half = at + 0.5 * duration / kSteps * kPendulum * (at - p);
    at += duration / kSteps * kPendulum * (half - p);
  }
  return at;
}

// Where a step of the steady walk begins: on the foot at `stays`, onward by f at each step.
Eigen::Vector3d steady(double stays, double apart, const Eigen::Vector3d& onward) {
  const double e = std::exp(kPendulum * kSwing);
  return Eigen::Vector3d(stays + apart / (1 + e), 0, 0) + onward / (e - 1);
}

TEST(RockingBalance, InItsSteadyWalkThePushIsBelowTheFootThatStaysAndEveryStepBeginsLikeTheLast) {
  const std::unique_ptr<WalkingBalance> balance = make_walking_balance(false);
  const Eigen::Vector3d belongs(0.4, 0, 0), onward(0, 0, 0.1);
  const Stance first = rocking(0, steady(0, 0.4, onward), belongs, belongs + onward);
  EXPECT_LT(balance->push(first).norm(), 1e-12);
  EXPECT_LT(balance->further(first).norm(), 1e-12);
  // Then this foot follows from the other side.
  const Eigen::Vector3d next = fallen(first.capture_point, balance->push(first), kSwing) - belongs - onward;
  EXPECT_LT((next - steady(0, -0.4, onward)).norm(), 1e-6);
}

TEST(RockingBalance, APushLeadsTheCapturePointBackInTime) {
  const std::unique_ptr<WalkingBalance> balance = make_walking_balance(false);
  const Eigen::Vector3d belongs(0.4, 0, 0), steady_one = steady(0, 0.4, {0, 0, 0});
  const Stance pushed = rocking(0, steady_one + Eigen::Vector3d(0.01, 0, -0.02), belongs, belongs);
  const Eigen::Vector3d aim = fallen(steady_one, {0, 0, 0}, kSwing);
  EXPECT_LT((fallen(pushed.capture_point, balance->push(pushed), kSwing) - aim).norm(), 1e-6);
  EXPECT_LT(balance->further(pushed).norm(), 1e-12) << "no need to";
}

TEST(RockingBalance, AFootGoesFurtherWhereNoPushOfTheOtherHelps) {
  const std::unique_ptr<WalkingBalance> balance = make_walking_balance(false);
  const Eigen::Vector3d belongs(0.4, 0, 0);
  const Stance tripped = rocking(0, {0.1, 0, 0.3}, belongs, belongs);
  EXPECT_NEAR(balance->push(tripped).z(), 0.9 * 0.2, 1e-12) << "at the edge";
  EXPECT_GT(balance->further(tripped).z(), 0.05);
  EXPECT_LE(balance->further(tripped).norm(), 0.1 + 1e-12);
}

// Two feet, one of which is about to step.
Stance shifting(double capture_point) {
  return {Stance::shift,
          1,
          kPendulum,
          {capture_point, 0, 0},
          rectangles(-0.2, 0.2),
          rectangles(-0.2, 0.2),
          rectangle(-0.2),
          {0.2, 0, 0},
          {0.25, 0, 0},
          kSwing,
          kSwing};
}

TEST(ShiftingBalance, LeadsTheCapturePointAboveTheFootThatStaysBeforeTheOtherSteps) {
  const std::unique_ptr<WalkingBalance> balance = make_walking_balance(true);
  const Stance between = shifting(0);
  EXPECT_FALSE(balance->can_step(between));
  const Eigen::Vector3d later = fallen(between.capture_point, balance->push(between), 0.1);
  EXPECT_LT(later.x(), -0.05) << "it goes there";
  const Stance above = shifting(-0.15);
  EXPECT_TRUE(balance->can_step(above));
  EXPECT_LT((balance->push(above) - above.capture_point).norm(), 1e-12)
      << "and stays there, on the side of the other";
}

TEST(ShiftingBalance, LandsAtOnceWhenItFalls) {
  const std::unique_ptr<WalkingBalance> balance = make_walking_balance(true);
  EXPECT_FALSE(balance->must_land(shifting(-0.05)));
  EXPECT_TRUE(balance->must_land(shifting(0.05))) << "more than a tenth of its height beside the foot";
}

}  // namespace
}  // namespace vivify::sim
