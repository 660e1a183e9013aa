#include "render/warp.h"

#include <gtest/gtest.h>

#include "common/rng.h"
#include "tests/render/render_support.h"

namespace vivify::render {
namespace {

using testing_support::direction_fit;
using testing_support::goodness_of_fit;
using testing_support::sidak;

constexpr int kTests = 8;  // of a distribution in this file
constexpr int kSamples = 100000;

TEST(Warp, DiskIsUniform) {
  constexpr int kRings = 10, kSectors = 16;
  std::vector<double> counts(kRings * kSectors),
      expected(kRings * kSectors, kSamples / double(kRings * kSectors));
  CounterRng rng(1);
  for (int s = 0; s < kSamples; ++s) {
    const Vec2 d = sample_disk({static_cast<float>(rng.uniform()), static_cast<float>(rng.uniform())});
    const double r2 = double(d.x) * d.x + double(d.y) * d.y;
    ASSERT_LE(r2, 1 + 1e-6);
    const int ring = std::min(static_cast<int>(r2 * kRings), kRings - 1);
    const int sector =
        std::min(static_cast<int>((std::atan2(d.y, d.x) / (2 * M_PI) + 0.5) * kSectors), kSectors - 1);
    counts[static_cast<std::size_t>(ring * kSectors + sector)] += 1;
  }
  EXPECT_GT(goodness_of_fit(counts, expected), sidak(kTests));
}

TEST(Warp, CosineHemisphere) {
  double integral = 0;
  const double p =
      direction_fit([](const Vec2& u, float, Vec3& d) { return d = sample_cosine_hemisphere(u), true; },
                    [](const Vec3& d) { return std::max(0.0f, d.z) / kPi; }, {0, 0, 1}, -1, 2, &integral);
  EXPECT_GT(p, sidak(kTests));
  EXPECT_NEAR(integral, 1, 1e-3);
}

TEST(Warp, Cone) {
  for (const float c : {0.3f, 1.0f, 2.0f}) {  // 2: the whole sphere
    double integral = 0;
    const double p = direction_fit([&](const Vec2& u, float, Vec3& d) { return d = sample_cone(u, c), true; },
                                   [&](const Vec3& d) { return d.z >= 1 - c ? cone_pdf(c) : 0; }, {0, 0, 1},
                                   1 - c, 3, &integral);
    EXPECT_GT(p, sidak(kTests)) << c;
    EXPECT_NEAR(integral, 1, 1e-3);
  }
}

TEST(Warp, PixelFilterIsATent) {
  constexpr int kCells = 40;
  std::vector<double> counts(kCells), expected;
  CounterRng rng(4);
  for (int s = 0; s < kSamples; ++s) {
    const double x = sample_tent(static_cast<float>(rng.uniform()));
    ASSERT_LE(std::abs(x), 1);
    counts[static_cast<std::size_t>(std::min((x + 1) / 2 * kCells, kCells - 1.0))] += 1;
  }
  for (int i = 0; i < kCells; ++i) {
    const double middle = std::abs(2 * (i + 0.5) / kCells - 1);
    expected.push_back(kSamples * (1 - middle) * 2 / kCells);
  }
  EXPECT_GT(goodness_of_fit(counts, expected), sidak(kTests));
}

TEST(Warp, PiecewiseConstantDistributions) {
  const std::vector<double> weights = {3, 0, 1, 2, 0, 5};
  const Distribution2D square(weights, 3, 2);
  constexpr int kFine = 6;  // cells per cell and side
  std::vector<double> counts(6 * kFine * kFine), expected;
  CounterRng rng(5);
  for (int s = 0; s < kSamples; ++s) {
    float pdf;
    const Vec2 p = square.sample({static_cast<float>(rng.uniform()), static_cast<float>(rng.uniform())}, pdf);
    EXPECT_FLOAT_EQ(pdf, square.pdf(p));
    EXPECT_GT(pdf, 0);
    const int x = std::min(static_cast<int>(p.x * 3 * kFine), 3 * kFine - 1);
    const int y = std::min(static_cast<int>(p.y * 2 * kFine), 2 * kFine - 1);
    counts[static_cast<std::size_t>(y * 3 * kFine + x)] += 1;
  }
  for (int y = 0; y < 2 * kFine; ++y) {
    for (int x = 0; x < 3 * kFine; ++x) {
      expected.push_back(kSamples * weights[static_cast<std::size_t>(y / kFine * 3 + x / kFine)] / 11 /
                         (kFine * kFine));
    }
  }
  EXPECT_GT(goodness_of_fit(counts, expected), sidak(kTests));

  // The place inside a cell is uniform as well.
  const Distribution1D line({1, 0, 3});
  std::vector<double> places(20);
  for (int s = 0; s < kSamples; ++s) {
    float u = static_cast<float>(rng.uniform());
    EXPECT_NE(line.sample(u), 1u);
    places[static_cast<std::size_t>(u * 20)] += 1;
  }
  EXPECT_GT(goodness_of_fit(places, std::vector<double>(20, kSamples / 20.0)), sidak(kTests));
}

// The test itself must be able to fail: a slightly wrong density is found.
TEST(Warp, GoodnessOfFitFindsAWrongDensity) {
  const double p = direction_fit(
      [](const Vec2& u, float, Vec3& d) { return d = sample_cosine_hemisphere(u), true; },
      [](const Vec3& d) { return d.z > 0 ? (0.1f / 2 + 0.9f * d.z) / kPi : 0; }, {0, 0, 1}, -1, 6);
  EXPECT_LT(p, 1e-6);
  EXPECT_NEAR(testing_support::chi_square_p(18.307, 10), 0.05, 1e-4);  // table of the chi-square distribution
  EXPECT_NEAR(testing_support::chi_square_p(2.558, 10), 0.99, 1e-4);
}

}  // namespace
}  // namespace vivify::render
