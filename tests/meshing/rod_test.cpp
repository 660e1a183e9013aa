#include "meshing/rod.h"

#include <gtest/gtest.h>

#include <numbers>

#include "common/error.h"
#include "meshing/polygons.h"
#include "tests/meshing/plane_shapes.h"

namespace vivify::meshing {
namespace {

Eigen::VectorXd edge_lengths(const Rod& rod) {
  Eigen::VectorXd lengths(rod.E.rows());
  for (Eigen::Index e = 0; e < rod.E.rows(); ++e) {
    lengths[e] = (rod.V.row(rod.E(e, 1)) - rod.V.row(rod.E(e, 0))).norm();
  }
  return lengths;
}

bool has_vertex(const Rod& rod, const Eigen::RowVector2d& p) {
  return (rod.V.rowwise() - p).rowwise().norm().minCoeff() == 0;
}

TEST(Rod, StraightLineIsSpreadEvenly) {
  const Rod rod = rod_from_polyline(shapes::polygon({{0, 0}, {0.3, 0}, {2, 0}}), false, 5);
  EXPECT_LE((rod.V - shapes::polygon({{0, 0}, {0.5, 0}, {1, 0}, {1.5, 0}, {2, 0}})).cwiseAbs().maxCoeff(),
            1e-15);
  Edges wanted(4, 2);
  wanted << 0, 1, 1, 2, 2, 3, 3, 4;
  EXPECT_EQ(rod.E, wanted);
}

TEST(Rod, CornersAreKeptAndEdgesAreNearlyEqual) {
  const Points2 u = shapes::u_polygon();
  const Rod rod = rod_from_polyline(u, true, 64);
  EXPECT_EQ(rod.V.rows(), 64);
  EXPECT_EQ(rod.E.rows(), 64);
  EXPECT_EQ(rod.E(63, 1), 0);
  for (Eigen::Index i = 0; i < u.rows(); ++i) EXPECT_TRUE(has_vertex(rod, u.row(i))) << i;
  const Eigen::VectorXd lengths = edge_lengths(rod);
  EXPECT_NEAR(lengths.sum(), perimeter(u), 1e-12);
  EXPECT_LT(lengths.maxCoeff() / lengths.minCoeff(), 1.3);
}

TEST(Rod, SmoothClosedCurve) {
  const Rod rod = rod_from_polyline(shapes::regular_polygon(720), true, 36);
  const Eigen::VectorXd lengths = edge_lengths(rod);
  EXPECT_LT(lengths.maxCoeff() / lengths.minCoeff(), 1 + 1e-3);
  EXPECT_NEAR(lengths.mean(), 2 * std::sin(std::numbers::pi / 36), 1e-5);
  EXPECT_EQ(rod.V.row(0), Eigen::RowVector2d(1, 0));
}

TEST(Rod, RepeatedPointsDoNotMatter) {
  const Rod rod =
      rod_from_polyline(shapes::polygon({{0, 0}, {0, 0}, {1, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}}), true, 8);
  EXPECT_NEAR(edge_lengths(rod).minCoeff(), 0.5, 1e-15);
  EXPECT_NEAR(edge_lengths(rod).maxCoeff(), 0.5, 1e-15);
}

TEST(Rod, BadPolylinesAreErrors) {
  EXPECT_THROW(rod_from_polyline(shapes::u_polygon(), true, 7), Error);
  EXPECT_THROW(rod_from_polyline(shapes::polygon({{1, 1}, {1, 1}}), false, 7), Error);
  EXPECT_THROW(rod_from_polyline(shapes::polygon({{1, 1}, {1, NAN}}), false, 7), Error);
  EXPECT_NO_THROW(rod_from_polyline(shapes::u_polygon(), true, 8));
}

}  // namespace
}  // namespace vivify::meshing
