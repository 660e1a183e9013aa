// Spheres and cards dropped into a bowl.
#include <gtest/gtest.h>

#include "tests/sim/pile.h"

namespace vivify::sim {
namespace {

class BigPile : public ::testing::TestWithParam<bench::Pile> {};

TEST_P(BigPile, Settles) {
  const PileResult result = settle_pile(GetParam(), 3);
  EXPECT_LE(result.residual, 1e-8);
  EXPECT_EQ(result.escaped, 0);
  EXPECT_LE(result.deepest_at_rest, 0.01 * bench::kPileRadius);
  EXPECT_LE(result.fastest_at_rest, 0.05);
}

INSTANTIATE_TEST_SUITE_P(At, BigPile,
                         ::testing::Values(bench::Pile{.spheres = 50, .cards = 10, .speed = 1},
                                           bench::Pile{.spheres = 50, .speed = 10},
                                           bench::Pile{.cards = 10, .speed = 10}));

}  // namespace
}  // namespace vivify::sim
