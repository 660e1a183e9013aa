#include "meshing/skin.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "meshing/rod.h"
#include "meshing/surface_checks.h"

namespace vivify::meshing {
namespace {

Points2 circle(double radius, int corners) {
  Points2 points(corners, 2);
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    points.row(i) << radius * std::cos(angle), radius * std::sin(angle);
  }
  return points;
}

// A sheet of n by n squares of side `size` in the plane z = 0, facing +Z.
TriangleMesh sheet(int n, double size) {
  TriangleMesh mesh;
  mesh.V.resize((n + 1) * (n + 1), 3);
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) mesh.V.row(j * (n + 1) + i) << i * size, j * size, 0;
  }
  mesh.F.resize(2 * n * n, 3);
  for (int j = 0, f = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i, f += 2) {
      const int a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.F.row(f) << a, b, d;
      mesh.F.row(f + 1) << a, d, c;
    }
  }
  return mesh;
}

Eigen::Matrix2d turn(double angle) { return Eigen::Rotation2Dd(angle).toRotationMatrix(); }

TEST(RodBand, IsAClosedSolidOfItsThicknessAndDepth) {
  for (const bool closed : {true, false}) {
    for (const double bevel : {0.0, 0.01}) {
      const Rod rod = rod_from_polyline(circle(1, 200), closed, 60);
      const SkinnedSurface band = rod_band(rod.V, rod.E, 0.06, 0.3, bevel, 2);
      EXPECT_EQ(topology_problem(band.surface), "");
      double length = 0;
      for (const auto& e : rod.E.rowwise()) length += (rod.V.row(e[1]) - rod.V.row(e[0])).norm();
      EXPECT_NEAR(signed_volume(band.surface), length * (0.06 * 0.3 - 2 * bevel * bevel), 1e-4)
          << closed << " " << bevel;
      const Box box = bounding_box(band.surface.V);
      EXPECT_NEAR(box.min.z(), 2 - 0.15, 1e-12);
      EXPECT_NEAR(box.max.z(), 2 + 0.15, 1e-12);
    }
  }
}

TEST(RodBand, CornersKeepTheThickness) {
  Points2 corner(3, 2);
  corner << 0, 0, 1, 0, 1, 1;
  Edges edges(2, 2);
  edges << 0, 1, 1, 2;
  const SkinnedSurface band = rod_band(corner, edges, 0.2, 0.1, 0, 0);
  EXPECT_NEAR(signed_volume(band.surface), (2 * 0.2) * 0.1, 1e-12);  // inner and outer side cancel
  EXPECT_NEAR(bounding_box(band.surface.V).max.x(), 1.1, 1e-12);
}

TEST(RodBand, FollowsRigidMotionAndKeepsItsDepth) {
  const Rod rod = rod_from_polyline(circle(1, 200), false, 20);
  const SkinnedSurface band = rod_band(rod.V, rod.E, 0.06, 0.3, 0.01, 0.5);
  const RowMatrixXd x = (rod.V * turn(0.7).transpose()).rowwise() + Eigen::RowVector2d(3, -1);
  Points expected = band.surface.V;
  expected.leftCols<2>() =
      (band.surface.V.leftCols<2>() * turn(0.7).transpose()).rowwise() + Eigen::RowVector2d(3, -1);
  EXPECT_LT((draw(band.skin, rod.E, x) - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(ThickShell, SheetBecomesAPlate) {
  const TriangleMesh mesh = sheet(4, 0.25);
  const SkinnedSurface plate = thick_shell(mesh, mesh.V, mesh.F, 0.1);
  EXPECT_EQ(topology_problem(plate.surface), "");
  EXPECT_NEAR(signed_volume(plate.surface), 0.1, 1e-12);
  EXPECT_NEAR(bounding_box(plate.surface.V).max.z(), 0.05, 1e-15);
}

TEST(ThickShell, TurnedFacesAndSeamsAreNoBorders) {
  TriangleMesh mesh = sheet(2, 0.5);
  const Points V = mesh.V;
  const Triangles F = mesh.F;
  // Every triangle has corners of its own, and every second one is turned over.
  TriangleMesh torn;
  torn.V.resize(3 * F.rows(), 3);
  torn.F.resize(F.rows(), 3);
  torn.UV.resize(torn.V.rows(), 2);
  torn.part_names = {"even", "odd"};
  torn.face_part.resize(F.rows());
  for (int f = 0; f < F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      torn.V.row(3 * f + k) = V.row(F(f, k));
      torn.UV.row(3 * f + k) = V.row(F(f, k)).head<2>();
      torn.F(f, k) = 3 * f + (f % 2 == 0 ? k : 2 - k);
    }
    torn.face_part[f] = f % 2;
  }
  const SkinnedSurface plate = thick_shell(torn, V, F, 0.1);
  EXPECT_EQ(topology_problem(without_duplicates(plate.surface)), "");
  EXPECT_NEAR(signed_volume(plate.surface), 0.1, 1e-12);
  EXPECT_EQ(plate.surface.F.rows(), 2 * 8 + 2 * 8);
  EXPECT_EQ(plate.surface.UV.rows(), plate.surface.V.rows());
  for (Eigen::Index f = 0; f < plate.surface.F.rows(); ++f) {
    EXPECT_EQ(plate.surface.face_part[f], (plate.surface.F(f, 0) % (3 * F.rows())) / 3 % 2) << f;
  }
}

TEST(ThickShell, FollowsRigidMotion) {
  const TriangleMesh coarse = sheet(2, 0.5), fine = sheet(5, 0.2);
  TriangleMesh bumpy = fine;
  for (Eigen::Index i = 0; i < bumpy.V.rows(); ++i)
    bumpy.V(i, 2) = 0.02 * std::sin(9 * bumpy.V(i, 0)) * bumpy.V(i, 1);
  const SkinnedSurface plate = thick_shell(bumpy, coarse.V, coarse.F, 0.1);
  // At rest the drawn surface is the given one, moved to both sides.
  EXPECT_LT((plate.surface.V.topRows(36).rowwise() - Eigen::RowVector3d(0, 0, 0.05) - bumpy.V)
                .cwiseAbs()
                .maxCoeff(),
            1e-12);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const Eigen::RowVector3d t(0.5, 1, -2);
  const RowMatrixXd x = (coarse.V * R.transpose()).rowwise() + t;
  const Points expected = (plate.surface.V * R.transpose()).rowwise() + t;
  EXPECT_LT((draw(plate.skin, coarse.F, x) - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(EmbedEdges, GivesVerticesAndMiddlesOnce) {
  const TriangleMesh mesh = sheet(2, 0.5);
  const Embedding embedding = embed_edges(mesh.F);
  const Eigen::Index edges = 9 + 8 - 1;  // Euler
  ASSERT_EQ(embedding.element.size(), 9 + edges);
  const RowMatrixXd points = interpolate(embedding, mesh.F, mesh.V);
  EXPECT_EQ(points.topRows(9), mesh.V);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) EXPECT_GT((points.row(i) - points.row(j)).norm(), 0.1);
  }
}

}  // namespace
}  // namespace vivify::meshing
