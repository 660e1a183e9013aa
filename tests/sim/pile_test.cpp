// Many bodies in a bowl.
#include "tests/sim/pile.h"

#include <gtest/gtest.h>

namespace vivify::sim {
namespace {

TEST(Pile, SpheresSettleInABowl) {
  const PileResult result = settle_pile({.spheres = 8, .cards = 0, .speed = 2}, 2);
  EXPECT_LE(result.residual, 1e-8);
  EXPECT_LE(result.deepest_at_rest, 0.01 * bench::kPileRadius);
  EXPECT_LE(result.fastest_at_rest, 1e-3);
  EXPECT_EQ(result.escaped, 0);
}

}  // namespace
}  // namespace vivify::sim
