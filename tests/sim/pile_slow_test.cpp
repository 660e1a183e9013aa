// Fifty spheres and ten cards dropped into a bowl.
#include <gtest/gtest.h>

#include "tests/sim/pile.h"

namespace vivify::sim {
namespace {

class BigPile : public ::testing::TestWithParam<double> {};

TEST_P(BigPile, Settles) {
  const PileResult result = settle_pile({.spheres = 50, .cards = 10, .speed = GetParam()}, 3);
  EXPECT_LE(result.residual, 1e-8);
  EXPECT_EQ(result.escaped, 0);
  EXPECT_LE(result.deepest_at_rest, 0.01 * bench::kPileRadius);
  EXPECT_LE(result.fastest_at_rest, 0.1);
}

INSTANTIATE_TEST_SUITE_P(At, BigPile, ::testing::Values(1.0, 10.0));

}  // namespace
}  // namespace vivify::sim
