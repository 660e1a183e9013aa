#include "pipeline/canvas.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace vivify::pipeline {
namespace {

constexpr int kWidth = 60, kHeight = 40;
constexpr Colour kWhite = {255, 255, 255};

struct Picture {
  std::vector<std::uint8_t> pixels = std::vector<std::uint8_t>(3 * kWidth * kHeight, 0);
  Canvas canvas{pixels.data(), kWidth, 0, 0, kWidth, kHeight};

  double at(int x, int y) const { return pixels[static_cast<std::size_t>(3 * (y * kWidth + x))] / 255.0; }
  // Area that is covered, pixels.
  double area() const { return std::accumulate(pixels.begin(), pixels.end(), 0.0) / (3 * 255); }
};

TEST(Canvas, StrokesCoverTheirArea) {
  Picture line, disc, ring, arrow;
  line.canvas.line({10.3, 8.1}, {48.7, 30.2}, 3, kWhite);
  EXPECT_NEAR(line.area(), 3 * std::hypot(38.4, 22.1) + M_PI * 1.5 * 1.5, 1.5);
  disc.canvas.disc({20.4, 20.7}, 6, kWhite);
  EXPECT_NEAR(disc.area(), M_PI * 36, 1.5);
  ring.canvas.ring({30, 20}, 10, 2, kWhite);
  EXPECT_NEAR(ring.area(), 2 * M_PI * 10 * 2, 1.5);
  // A shaft with one round end, and a triangle of 8 by 7.2.
  arrow.canvas.arrow({10, 20.5}, {40, 20.5}, 2, kWhite);
  EXPECT_NEAR(arrow.area(), 2 * 22 + M_PI / 2 + 8 * 7.2 / 2, 3);
  EXPECT_GT(arrow.at(38, 20), 0.9);
  EXPECT_EQ(arrow.at(42, 20), 0);
}

TEST(Canvas, EdgesAreSmooth) {
  Picture picture;
  picture.canvas.line({5, 20.25}, {55, 20.25}, 2, kWhite);
  EXPECT_NEAR(picture.at(30, 18), 0, 1e-2);
  EXPECT_NEAR(picture.at(30, 19), 0.75, 1e-2);
  EXPECT_NEAR(picture.at(30, 20), 1, 1e-2);
  EXPECT_NEAR(picture.at(30, 21), 0.25, 1e-2);
}

TEST(Canvas, OpacityBlends) {
  Picture picture;
  picture.canvas.fill({200, 200, 200});
  picture.canvas.disc({30, 20}, 5, {0, 0, 0}, 0.25);
  EXPECT_NEAR(picture.at(30, 20), 150.0 / 255, 1e-2);
  EXPECT_NEAR(picture.at(5, 5), 200.0 / 255, 1e-9);
}

TEST(Canvas, StaysWithinItsPart) {
  Picture picture;
  Canvas part(picture.pixels.data(), kWidth, 20, 10, 15, 12);
  part.fill({10, 10, 10});
  part.line({-100, -50}, {200, 90}, 30, kWhite);
  part.disc({15, 12}, 40, kWhite);
  part.line({NAN, 3}, {5, INFINITY}, 3, kWhite);
  part.arrow({1e9, 2}, {-1e9, 3}, 3, kWhite);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool inside = x >= 20 && x < 35 && y >= 10 && y < 22;
      EXPECT_EQ(picture.at(x, y), inside ? 1 : 0) << x << " " << y;
    }
  }
}

}  // namespace
}  // namespace vivify::pipeline
