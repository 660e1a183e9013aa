#include "meshing/enclosure.h"

#include <gtest/gtest.h>

#include "tests/meshing/cage_shapes.h"

namespace vivify::meshing {
namespace {

TEST(Enclosure, ClosestPointOnATriangleBeatsEverySample) {
  CounterRng rng(1);
  const auto random = [&] {
    return Eigen::Vector3d(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
  };
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Vector3d a = random(), b = random(), c = random(), p = 2 * random();
    const Eigen::Vector3d q = closest_on_triangle(p, a, b, c);
    double sampled = 1e300;
    constexpr int kSteps = 60;
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        const double u = double(i) / kSteps, v = double(j) / kSteps;
        sampled = std::min(sampled, (a + u * (b - a) + v * (c - a) - p).norm());
      }
    }
    EXPECT_LE((q - p).norm(), sampled + 1e-12);
    EXPECT_GE((q - p).norm(), sampled - 2.0 * 3.5 / kSteps);
  }
}

TEST(Enclosure, WindingNumber) {
  TriangleMesh torus = shapes::torus(1, 0.4);
  EXPECT_NEAR(winding_number(torus, {1, 0.1, 0}), 1, 1e-12);
  EXPECT_NEAR(winding_number(torus, {0, 0, 0}), 0, 1e-12);
  EXPECT_NEAR(winding_number(torus, {5, 1, 0}), 0, 1e-12);
  torus.F = torus.F.rowwise().reverse().eval();
  EXPECT_NEAR(winding_number(torus, {1, 0.1, 0}), -1, 1e-12);
}

TEST(Enclosure, PointsNotInside) {
  const TriangleMesh box = shapes::box({0, 0, 0}, {1, 1, 1});
  Points points(4, 3);
  points << 0.5, 0.5, 0.5, 0.5, 0.5, 0.95, 0.5, 0.5, 1, 0.5, 0.5, 1.1;
  EXPECT_EQ(points_not_inside(box, points), (std::vector<int>{2, 3}));
  EXPECT_EQ(points_not_inside(box, points, 0.1), (std::vector<int>{1, 2, 3}));
  EXPECT_NEAR(distance_to(box, points.row(3)), 0.1, 1e-15);
}

TEST(Enclosure, ListsNoMoreThanFive) {
  EXPECT_EQ(list_some("vertices", {1, 2}), "vertices 1 and 2");
  EXPECT_EQ(list_some("vertices", {1, 2, 3, 4, 5, 6, 7}), "vertices 1, 2, 3, 4, 5 and 2 more");
}

}  // namespace
}  // namespace vivify::meshing
