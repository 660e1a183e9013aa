// Closest points against fine samples, also of triangles and segments without size.
#include "sim/contact/closest_points.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "tests/sim/contact_shapes.h"

namespace vivify::sim {
namespace {

using Eigen::Vector3d;

// The place is a convex combination that no sample of the triangle is nearer than.
void expect_nearest(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const TrianglePlace place = nearest_on_triangle(p, a, b, c);
  const auto [u, v, w] = place.weights;
  EXPECT_GE(std::min({u, v, w}), 0);
  EXPECT_NEAR(u + v + w, 1, 1e-14);
  EXPECT_LE((u * a + v * b + w * c - place.position).norm(), 1e-14);
  const double distance = (place.position - p).norm();
  for (int i = 0; i <= 40; ++i) {
    for (int k = 0; k + i <= 40; ++k) {
      const Vector3d sample = a + (b - a) * (i / 40.0) + (c - a) * (k / 40.0);
      ASSERT_GE((sample - p).norm(), distance - 1e-12);
    }
  }
  // The feature is the smallest that the place lies on.
  const int zeros = (u == 0) + (v == 0) + (w == 0);
  EXPECT_EQ(zeros, place.feature == 0 ? 0 : place.feature >= 4 ? 1 : 2);
  if (place.feature >= 1 && place.feature <= 3) {
    EXPECT_EQ(place.weights[place.feature - 1], 1);
  }
  if (place.feature >= 4) {
    EXPECT_EQ(place.weights[(place.feature - 2) % 3], 0);
  }
}

TEST(ClosestPoints, OnRandomTriangles) {
  CounterRng rng(1);
  for (int trial = 0; trial < 300; ++trial) {
    expect_nearest(random_point(2, rng), random_point(1, rng), random_point(1, rng), random_point(1, rng));
  }
}

TEST(ClosestPoints, OnTrianglesWithoutArea) {
  CounterRng rng(2);
  for (int trial = 0; trial < 100; ++trial) {
    const Vector3d p = random_point(2, rng), a = random_point(1, rng), b = random_point(1, rng);
    const Vector3d corners[3] = {a, b, a + rng.uniform(-1, 2) * (b - a)};
    const int turn = trial % 3;
    expect_nearest(p, corners[turn], corners[(turn + 1) % 3], corners[(turn + 2) % 3]);
    for (const auto& [x, y, z] : {std::tuple(a, a, b), {a, b, a}, {b, a, a}, {a, a, a}}) {
      const TrianglePlace place = nearest_on_triangle(p, x, y, z);
      const TrianglePlace line = nearest_on_segment(p, a, x == y && y == z ? a : b);
      EXPECT_LE((place.position - line.position).norm(), 1e-14);
      EXPECT_TRUE(std::isfinite(place.weights[0] + place.weights[1] + place.weights[2]));
    }
  }
}

void expect_nearest_segments(const Vector3d& a0, const Vector3d& a1, const Vector3d& b0, const Vector3d& b1) {
  const auto [s, t, offset] = nearest_on_segments(a0, a1, b0, b1);
  EXPECT_GE(std::min(s, t), 0);
  EXPECT_LE(std::max(s, t), 1);
  EXPECT_LE((a0 + s * (a1 - a0) - b0 - t * (b1 - b0) - offset).norm(), 1e-14);
  for (int i = 0; i <= 40; ++i) {
    const double along = i / 40.0;
    const Vector3d on_a = a0 + along * (a1 - a0), on_b = b0 + along * (b1 - b0);
    ASSERT_GE((nearest_on_segment(on_a, b0, b1).position - on_a).norm(), offset.norm() - 1e-12);
    ASSERT_GE((nearest_on_segment(on_b, a0, a1).position - on_b).norm(), offset.norm() - 1e-12);
  }
  EXPECT_NEAR(nearest_on_segments(b0, b1, a0, a1).offset.norm(), offset.norm(), 1e-14);
}

TEST(ClosestPoints, OfTwoSegments) {
  CounterRng rng(3);
  for (int trial = 0; trial < 500; ++trial) {
    const Vector3d a0 = random_point(1, rng), a1 = random_point(1, rng), b0 = random_point(1, rng);
    expect_nearest_segments(a0, a1, b0, random_point(1, rng));
    expect_nearest_segments(a0, a1, b0, b0 + rng.uniform(-2, 2) * (a1 - a0));  // parallel
    expect_nearest_segments(a0, a0, b0, a1);                                   // a point
    expect_nearest_segments(a0, a0, b0, b0);
  }
}

TEST(ClosestPoints, AnglesOfCorners) {
  EXPECT_NEAR(corner_angle({0, 0, 0}, {1, 0, 0}, {0, 0, 3}), std::numbers::pi / 2, 1e-15);
  EXPECT_NEAR(corner_angle({1, 1, 0}, {2, 1, 0}, {0, 2, 0}), 3 * std::numbers::pi / 4, 1e-15);
  EXPECT_EQ(corner_angle({1, 1, 0}, {1, 1, 0}, {0, 2, 0}), 0);
}

}  // namespace
}  // namespace vivify::sim
