#include "common/rng.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <set>

namespace vivify {
namespace {

TEST(CounterRng, MomentsAndCorrelationAreThoseOfAUniformVariable) {
  constexpr int kCount = 200000;
  for (const std::uint64_t key : {0ULL, 1ULL, 2ULL, ~0ULL}) {
    CounterRng rng(key);
    double mean = 0, square = 0, lagged = 0, last = 0.5;
    for (int i = 0; i < kCount; ++i) {
      const double u = rng.uniform();
      ASSERT_GE(u, 0);
      ASSERT_LT(u, 1);
      mean += u;
      square += (u - 0.5) * (u - 0.5);
      lagged += (u - 0.5) * (last - 0.5);
      last = u;
    }
    // four standard errors
    EXPECT_NEAR(mean / kCount, 0.5, 4 * std::sqrt(1.0 / 12 / kCount));
    EXPECT_NEAR(square / kCount, 1.0 / 12, 4 * std::sqrt(1.0 / 180 / kCount));
    EXPECT_NEAR(lagged / kCount, 0, 4 / 12.0 / std::sqrt(kCount));
  }
}

TEST(CounterRng, EveryInputBitChangesHalfOfTheOutput) {
  double flips = 0;
  int count = 0;
  for (std::uint64_t key = 0; key < 200; ++key) {
    for (int bit = 0; bit < 64; ++bit, ++count) {
      flips += std::popcount(hash_words(key, 5) ^ hash_words(key ^ (1ULL << bit), 5));
    }
  }
  EXPECT_NEAR(flips / count, 32, 4 * 4 / std::sqrt(count));
}

TEST(HashWords, OrderAndNumberOfWordsCount) {
  static_assert(hash_words(1, 2, 3) != hash_words(1, 3, 2));
  std::set<std::uint64_t> seen;
  for (std::uint64_t a = 0; a < 50; ++a) {
    for (std::uint64_t b = 0; b < 50; ++b) seen.insert(hash_words(a, b));
    seen.insert(hash_words(a));
  }
  EXPECT_EQ(seen.size(), 2550U);
}

TEST(CounterRng, DependsOnKeyAndCounterOnly) {
  CounterRng a(9), b(9);
  CounterRng(10).next();
  for (int i = 0; i < 10; ++i) EXPECT_EQ(a.next(), b.next());
  EXPECT_EQ(CounterRng(9).next(), hash_words(9, 0));
}

}  // namespace
}  // namespace vivify
