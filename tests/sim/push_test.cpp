// Pushes from outside: all of the impulse arrives, whatever the step, and no more.
#include "sim/push.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

TEST(Pushes, GiveTheWholeImpulseOverTheirTime) {
  const std::vector<Push> pushes = {{0.2, 0.5, {1, 0, -2}}, {0.4, 0.1, {0, 3, 0}}};
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int step = 0; step < 7; ++step) sum += impulse_between(pushes, 0.13 * step, 0.13 * (step + 1));
  EXPECT_LE((sum - Eigen::Vector3d(1, 3, -2)).norm(), 1e-14);
  EXPECT_EQ(impulse_between(pushes, 0, 0.2), Eigen::Vector3d::Zero());
  EXPECT_LE((impulse_between(pushes, 0.3, 0.45) - Eigen::Vector3d(0.3, 1.5, -0.6)).norm(), 1e-14);
}

// A soft body in the air takes up exactly the impulse, and is not turned by it.
TEST(Pushes, ChangeTheMomentumByTheirImpulse) {
  for (const double h : {1.0 / 48, 1.0 / 37, 1.0 / 200}) {
    BodyInput input = box_input(small_box());
    const Eigen::Vector3d impulse(4, 10, -3);
    input.pushes = {{0.1, 0.13, impulse}};
    World world({input}, {}, {.gravity = Eigen::Vector3d::Zero(), .h = h});
    const double mass = world.body(0).model().mass.sum();
    while (world.time() < 0.4) {
      world.step();
      const StepRecord& r = world.records().back();
      const double share = std::clamp((world.time() - 0.1) / 0.13, 0.0, 1.0);
      EXPECT_LE((mass * r.vel - share * impulse).norm(), 1e-9 * impulse.norm()) << world.time();
      EXPECT_LE(r.internal_force, 1e-9 * world.body(0).model().weight);
      EXPECT_LE(r.tilt_deg, 1e-5);
    }
  }
}

}  // namespace
}  // namespace vivify::sim
