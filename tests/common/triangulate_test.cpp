#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "common/polygon_mesh.h"
#include "common/rng.h"

namespace vivify {
namespace {

using Corners = std::vector<Eigen::Vector3d>;

Eigen::Vector3d area_vector(const Corners& corners) {
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    area += (corners[i] - corners[0]).cross(corners[i + 1] - corners[0]) / 2;
  }
  return area;
}

// Triangles that all turn the same way and whose areas add up to that of a simple polygon tile it.
void expect_tiling(const Corners& corners) {
  const auto triangles = triangulate(corners);
  ASSERT_EQ(triangles.size(), corners.size() - 2);
  const Eigen::Vector3d whole = area_vector(corners), normal = whole.normalized();
  double sum = 0;
  for (const Eigen::Vector3i& t : triangles) {
    const auto at = [&](int k) { return corners[static_cast<std::size_t>(t[k])]; };
    const double area = (at(1) - at(0)).cross(at(2) - at(0)).dot(normal) / 2;
    EXPECT_GE(area, 0);
    sum += area;
  }
  EXPECT_NEAR(sum, whole.norm(), 1e-12 * whole.norm());
}

TEST(Triangulate, TilesConcavePolygons) {
  expect_tiling({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 0.5, 0}, {0, 2, 0}});
  expect_tiling({{0, 0, 0}, {0, 2, 0}, {1, 0.5, 0}, {2, 2, 0}, {2, 0, 0}});  // the other way round
  expect_tiling({{1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 0.1, 0.1}});
  expect_tiling({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}});  // a corner on a straight side
}

TEST(Triangulate, TilesStarsInAnyPlane) {
  CounterRng rng(4);
  for (int round = 0; round < 200; ++round) {
    const int count = 4 + static_cast<int>(rng.next() % 20);
    const Eigen::Matrix3d turn =
        Eigen::Quaterniond(
            Eigen::Vector4d(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1), 0.1).normalized())
            .toRotationMatrix();
    Corners corners;
    for (int i = 0; i < count; ++i) {
      const double angle = 2 * std::numbers::pi * i / count, radius = rng.uniform(0.1, 1);
      corners.push_back(turn * Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), 0) +
                        Eigen::Vector3d(3, -2, 1));
    }
    expect_tiling(corners);
  }
}

TEST(Triangulate, EndsForWhatIsNoSimplePolygon) {
  EXPECT_EQ(triangulate({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}).size(), 2U);  // crosses itself
  EXPECT_EQ(triangulate(Corners(6, Eigen::Vector3d(1, 2, 3))).size(), 4U);
  EXPECT_EQ(triangulate(Corners(5, Eigen::Vector3d(NAN, 0, 0))).size(), 3U);
}

}  // namespace
}  // namespace vivify
