#include "render/sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "common/rng.h"
#include "tests/render/render_support.h"

namespace vivify::render {
namespace {

using testing_support::goodness_of_fit;
using testing_support::sidak;

// Every elementary interval of area 1/n holds exactly one of the n = 2^m points.
TEST(Sampler, FirstTwoDimensionsOfEveryGroupAreNets) {
  for (int m = 0; m <= 8; ++m) {
    const std::uint32_t n = 1u << m;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      Sampler sampler(seed, n);
      for (std::uint32_t group = 0; group < 3; ++group) {
        for (int a = 0; a <= m; ++a) {
          std::set<std::pair<int, int>> cells;
          for (std::uint32_t i = 0; i < n; ++i) {
            sampler.start(i);
            sampler.go_to(group);
            const auto u = sampler.next();
            cells.insert({static_cast<int>(u[0] * (1 << a)), static_cast<int>(u[1] * (1 << (m - a)))});
          }
          EXPECT_EQ(cells.size(), n) << "m " << m << " split " << a << " seed " << seed << " group " << group;
        }
      }
    }
  }
}

TEST(Sampler, EveryDimensionIsStratifiedForPrefixesToo) {
  // The first 2^k of 2^m samples are nets as well.
  Sampler sampler(7, 64);
  for (int d = 0; d < 4; ++d) {
    for (const std::uint32_t n : {4u, 16u, 64u}) {
      std::set<int> cells;
      for (std::uint32_t i = 0; i < n; ++i) {
        sampler.start(i);
        cells.insert(static_cast<int>(sampler.next()[static_cast<std::size_t>(d)] * static_cast<float>(n)));
      }
      EXPECT_EQ(cells.size(), n) << "dimension " << d;
    }
  }
}

TEST(Sampler, NumbersAreUniformOverSeeds) {
  constexpr int kCells = 16, kSamples = 40000, kTests = 4 + 6 + 1;
  std::vector<std::vector<double>> single(4, std::vector<double>(kCells)),
      pair(6, std::vector<double>(kCells * kCells));
  std::vector<double> groups(kCells * kCells);
  for (int s = 0; s < kSamples; ++s) {
    Sampler sampler(static_cast<std::uint64_t>(s), 8);
    sampler.start(static_cast<std::uint32_t>(s % 8));
    const auto u = sampler.next();
    const auto v = sampler.next();
    const auto cell = [](float x) {
      EXPECT_TRUE(x >= 0 && x < 1);
      return static_cast<std::size_t>(x * kCells);
    };
    std::size_t p = 0;
    for (std::size_t a = 0; a < 4; ++a) {
      single[a][cell(u[a])] += 1;
      for (std::size_t b = a + 1; b < 4; ++b) pair[p++][cell(u[a]) * kCells + cell(u[b])] += 1;
    }
    groups[cell(u[0]) * kCells + cell(v[0])] += 1;
  }
  const auto uniform = [](std::size_t n) {
    return std::vector<double>(n, static_cast<double>(kSamples) / static_cast<double>(n));
  };
  for (const auto& c : single) EXPECT_GT(goodness_of_fit(c, uniform(kCells)), sidak(kTests));
  for (const auto& c : pair) EXPECT_GT(goodness_of_fit(c, uniform(kCells * kCells)), sidak(kTests));
  EXPECT_GT(goodness_of_fit(groups, uniform(kCells * kCells)), sidak(kTests));
}

double rms_error(std::uint32_t n, bool random) {
  double squares = 0;
  constexpr int kRuns = 200;
  for (int run = 0; run < kRuns; ++run) {
    Sampler sampler(static_cast<std::uint64_t>(run), n);
    CounterRng rng(static_cast<std::uint64_t>(run) + 1000);
    double sum = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      sampler.start(i);
      const auto u = sampler.next();
      const double x = random ? rng.uniform() : u[0], y = random ? rng.uniform() : u[1];
      sum += std::sin(M_PI * x) * std::exp(y);
    }
    const double error = sum / n - 2 / M_PI * (std::exp(1.0) - 1);
    squares += error * error;
  }
  return std::sqrt(squares / kRuns);
}

TEST(Sampler, ConvergesFasterThanRandomNumbers) {
  EXPECT_LT(rms_error(16, false), 0.35 * rms_error(16, true));
  EXPECT_LT(rms_error(256, false), 0.05 * rms_error(256, true));
  // Smooth integrands: about n^-1.5 instead of n^-0.5.
  const double rate = std::log(rms_error(16, false) / rms_error(1024, false)) / std::log(64.0);
  EXPECT_GT(rate, 1.2);
}

TEST(Sampler, ScramblingKeepsTheOrderOfIntervals) {
  // Bit k of the result depends on the bits above it only: points in one dyadic interval stay in one.
  for (std::uint32_t seed = 1; seed < 50; ++seed) {
    const std::uint32_t x = 0x9e3779b9u * seed;
    for (int k = 1; k < 32; ++k) {
      const std::uint32_t other = x ^ (1u << (31 - k));
      EXPECT_EQ(owen_scramble(x, seed) >> (32 - k), owen_scramble(other, seed) >> (32 - k));
      EXPECT_NE((owen_scramble(x, seed) >> (31 - k)) & 1u, (owen_scramble(other, seed) >> (31 - k)) & 1u);
    }
  }
}

}  // namespace
}  // namespace vivify::render
