// Coarse surfaces for contact: closed, near the drawn one, and moving with the simulation mesh.
#include "meshing/contact_surface.h"

#include <gtest/gtest.h>

#include <map>

#include "meshing/closest_point.h"
#include "meshing/coarsen.h"
#include "meshing/planar_mesh.h"
#include "meshing/polygons.h"
#include "tests/meshing/plane_shapes.h"
#include "tests/meshing/solids.h"

namespace vivify::meshing {
namespace {

// Every edge belongs to two faces, once in each direction.
bool is_closed(const RowMatrixXi& F) {
  std::map<std::pair<int, int>, int> directed;
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) ++directed[{F(f, k), F(f, (k + 1) % 3)}];
  }
  return std::all_of(directed.begin(), directed.end(), [&](const auto& edge) {
    return edge.second == 1 && directed.contains({edge.first.second, edge.first.first});
  });
}

TEST(ContactSurface, OfACupIsCoarseClosedAndNear) {
  const TriangleMesh cup = shapes::cup(48);
  TetMesh mesh{Points(5, 3), Tetrahedra(2, 4)};  // around the cup
  mesh.V << 0, -3, 0, 3, 2, 0, 0, 2, 3, 0, 2, -3, -3, 2, 0;
  mesh.T << 0, 1, 3, 2, 0, 4, 2, 3;
  double last = INFINITY;
  for (const int points : {100, 300}) {
    const CoarseSurface coarse = coarse_contact_surface(cup, mesh, points);
    EXPECT_NEAR(static_cast<double>(coarse.V.rows()), points, 0.26 * points);
    EXPECT_TRUE(is_closed(coarse.F));
    const TriangleMesh surface{Points(coarse.V), Triangles(coarse.F), {}, {}, {}};
    EXPECT_FALSE(intersects_itself(surface));
    EXPECT_NEAR(signed_volume(surface) / signed_volume(cup), 1, 0.15);
    // No place of the coarse surface is farther from the cup than it says.
    const ClosestPoint drawn(cup);
    for (Eigen::Index f = 0; f < coarse.F.rows(); ++f) {
      for (const auto& [u, v] : {std::pair(0.5, 0.5), {0.5, 0.0}, {0.0, 0.5}, {0.2, 0.2}}) {
        const Eigen::Vector3d place = (1 - u - v) * coarse.V.row(coarse.F(f, 0)) +
                                      u * coarse.V.row(coarse.F(f, 1)) + v * coarse.V.row(coarse.F(f, 2));
        EXPECT_LE(drawn(place).distance, 1.5 * coarse.deviation);
      }
    }
    EXPECT_LT(coarse.deviation, 0.05);  // of a height of 0.72
    EXPECT_LT(coarse.deviation, last);
    last = coarse.deviation;
    // At rest and under an affine map the points go where the mesh goes.
    EXPECT_LE((interpolate(coarse.embedding, mesh.T, mesh.V) - coarse.V).norm(), 1e-10);
    Eigen::Matrix3d A;
    A << 1, 0.2, 0, -0.1, 0.9, 0.3, 0, 0.1, 1.2;
    EXPECT_LE((interpolate(coarse.embedding, mesh.T, mesh.V * A) - coarse.V * A).norm(), 1e-10);
  }
}

TEST(ContactSurface, OfASmallSurfaceIsTheSurface) {
  const TriangleMesh box = shapes::unit_box();
  TetMesh tet{Points(4, 3), Tetrahedra(1, 4)};
  tet.V << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  tet.T << 0, 1, 2, 3;
  const CoarseSurface coarse = coarse_contact_surface(box, tet, 160);
  EXPECT_EQ(coarse.V, box.V);
  EXPECT_EQ(coarse.F, box.F);
  EXPECT_NEAR(coarse.deviation, 0, 1e-15);
}

TEST(ContactSurface, OfAnOutlineKeepsItsCornersAndItsArea) {
  const Outline outline{{shapes::u_polygon()}};
  const PlanarMesh mesh = triangulate_outline(outline, 60);
  const CoarseSurface coarse = coarse_contact_outline(outline, mesh.V, mesh.F, 40);
  EXPECT_EQ(coarse.V.rows(), 40);
  EXPECT_LE(coarse.deviation, 1e-12);
  EXPECT_NEAR(signed_area(Points2(coarse.V)), outline.area(), 1e-12);
  for (Eigen::Index i = 0; i < outline.loops[0].rows(); ++i) {
    EXPECT_LE((coarse.V.rowwise() - RowMatrixXd(outline.loops[0]).row(i)).rowwise().norm().minCoeff(), 1e-12);
  }
  EXPECT_LE((interpolate(coarse.embedding, mesh.F, mesh.V) - coarse.V).norm(), 1e-10);
}

TEST(ContactSurface, OfARingHasBothLoopsWithTheMaterialOnTheLeft) {
  Points2 hole = shapes::regular_polygon(200, 0.5).colwise().reverse();
  const Outline outline{{shapes::regular_polygon(300, 1), hole}};
  const PlanarMesh mesh = triangulate_outline(outline, 120);
  const CoarseSurface coarse = coarse_contact_outline(outline, mesh.V, mesh.F, 60);
  ASSERT_EQ(coarse.F.rows(), 60);
  double area = 0;
  for (Eigen::Index e = 0; e < 60; ++e) {
    area += cross2(coarse.V.row(coarse.F(e, 0)).transpose(), coarse.V.row(coarse.F(e, 1)).transpose()) / 2;
  }
  EXPECT_NEAR(area / outline.area(), 1, 0.02);
  EXPECT_GT(coarse.deviation, 0);
  EXPECT_LT(coarse.deviation, 0.01);
}

TEST(ContactSurface, OfLoopsThatWouldMeetIsTheOutline) {
  // Two round shapes a hair apart: 8 points on each would cut through the other.
  Points2 inner = 0.99 * shapes::regular_polygon(400, 1).colwise().reverse();
  const Outline outline{{shapes::regular_polygon(400, 1), inner}};
  Points2 V(3, 2);
  V << -3, -3, 3, -3, 0, 5;
  Triangles F(1, 3);
  F << 0, 1, 2;
  const CoarseSurface coarse = coarse_contact_outline(outline, V, F, 13);
  EXPECT_EQ(coarse.V.rows(), 800);
  EXPECT_NEAR(coarse.deviation, 0, 1e-15);
}

}  // namespace
}  // namespace vivify::meshing
