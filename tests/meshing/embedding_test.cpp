#include "meshing/embedding.h"

#include <gtest/gtest.h>

#include "common/error.h"
#include "common/parallel.h"
#include "meshing/planar_mesh.h"
#include "tests/meshing/cage_shapes.h"
#include "tests/meshing/plane_shapes.h"

namespace vivify::meshing {
namespace {

// A cube mesh with irregular interior nodes.
TetMesh uneven_cube(int n) {
  TetMesh mesh = shapes::cube_tets(n);
  CounterRng rng(11);
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
    for (int k = 0; k < 3; ++k) {
      if (mesh.V(v, k) > 0 && mesh.V(v, k) < 1) mesh.V(v, k) += rng.uniform(-0.1, 0.1) / n;
    }
  }
  EXPECT_GT(tet_volumes(mesh).minCoeff(), 0);
  return mesh;
}

TEST(Embedding, PointsInsideLieInTheirTetrahedron) {
  const TetMesh mesh = uneven_cube(5);
  const Points points = shapes::random_points(2000, {0, 0, 0}, {1, 1, 1}, 1);
  const Embedding embedding = embed(mesh, points);
  EXPECT_GE(embedding.weights.minCoeff(), -1e-14);
  EXPECT_LE(embedding.largest_weight(), 1 + 1e-14);
  EXPECT_LE((interpolate(embedding, mesh.T, mesh.V) - points).rowwise().norm().maxCoeff(), 1e-15 * 10);
  EXPECT_LE((embedding.weights.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-15 * 4);
}

TEST(Embedding, ReproducesTheRestShapeOutsideTheMesh) {
  const TetMesh mesh = uneven_cube(4);
  const Points points = shapes::random_points(2000, {-0.2, -0.2, -0.2}, {1.2, 1.2, 1.2}, 2);
  const Embedding embedding = embed(mesh, points);
  EXPECT_LT(embedding.weights.minCoeff(), -0.1);
  EXPECT_LE((interpolate(embedding, mesh.T, mesh.V) - points).rowwise().norm().maxCoeff(),
            1e-12 * bounding_box(mesh.V).diagonal());
}

TEST(Embedding, AffineMapsAreExact) {
  const TetMesh mesh = uneven_cube(4);
  const Points points = shapes::random_points(1000, {-0.1, -0.1, -0.1}, {1.1, 1.1, 1.1}, 3);
  Eigen::Matrix3d linear;
  linear << 0.3, -1.2, 0.4, 0.9, 0.5, 0.1, -0.2, 0.7, 1.5;
  const Eigen::RowVector3d shift(3, -2, 1);
  const Points moved = (mesh.V * linear.transpose()).rowwise() + shift;
  const Points wanted = (points * linear.transpose()).rowwise() + shift;
  EXPECT_LE((interpolate(embed(mesh, points), mesh.T, moved) - wanted).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Embedding, OutsidePointsTakeTheClosestTetrahedron) {
  const TetMesh mesh = uneven_cube(3);
  const Points points = shapes::random_points(200, {-0.5, -0.5, -0.5}, {1.5, 1.5, 1.5}, 4);
  const Embedding embedding = embed(mesh, points);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    // The mesh fills the unit cube, so the closest point of the mesh is the clamped point; it must lie in the
    // chosen tetrahedron.
    const Eigen::RowVector3d clamped = points.row(i).cwiseMax(0).cwiseMin(1);
    TetMesh chosen;
    chosen.V = mesh.V;
    chosen.T = mesh.T.row(embedding.element[i]);
    EXPECT_GE(embed(chosen, Points(clamped)).weights.minCoeff(), -1e-5) << "point " << i;
  }
}

TEST(Embedding, AmongEquallyCloseTetrahedraTheOneWithSmallWeightsWins) {
  // Two tetrahedra share the edge on the z axis; the first is a sliver seen from the query point.
  TetMesh mesh;
  mesh.V.resize(6, 3);
  mesh.V << 0, 0, 0, 0, 0, 1, 1, 0, 0, 1, 1e-3, 0, 1, -1, 0.5, 1, 1, 0.5;
  mesh.T.resize(2, 4);
  mesh.T << 0, 2, 3, 1, 0, 4, 5, 1;
  ASSERT_GT(tet_volumes(mesh).minCoeff(), 0);
  Points point(1, 3);
  point << -0.2, 0.1, 0.5;
  const Embedding embedding = embed(mesh, point);
  EXPECT_EQ(embedding.element[0], 1);
  EXPECT_LT(embedding.largest_weight(), 2);
}

TEST(Embedding, SameForAnyNumberOfThreads) {
  const TetMesh mesh = uneven_cube(4);
  const Points points = shapes::random_points(3000, {-0.1, -0.1, -0.1}, {1.1, 1.1, 1.1}, 5);
  set_thread_count(1);
  const Embedding one = embed(mesh, points);
  set_thread_count(2);
  const Embedding two = embed(mesh, points);
  set_thread_count(0);
  EXPECT_EQ(one.element, two.element);
  EXPECT_EQ(one.weights, two.weights);
}

TEST(Embedding, RejectsAMeshWithoutVolume) {
  TetMesh flat = shapes::cube_tets(1);
  flat.V.col(1).setZero();
  EXPECT_THROW(embed(flat, flat.V), Error);
  Points broken(1, 3);
  broken << 0, std::nan(""), 0;
  EXPECT_THROW(embed(shapes::cube_tets(1), broken), Error);
}

class PlaneEmbedding : public ::testing::Test {
 protected:
  PlaneEmbedding() {
    mesh_ = triangulate_outline(clean_outline({shapes::u_polygon()}, FillRule::even_odd, "test"), 120);
    CounterRng rng(21);
    points_.resize(2000, 2);
    for (Eigen::Index i = 0; i < points_.rows(); ++i) {
      points_.row(i) << rng.uniform(-0.3, 3.3), rng.uniform(-0.3, 3.3);
    }
  }
  PlanarMesh mesh_;
  Points2 points_;
};

TEST_F(PlaneEmbedding, ReproducesPointsInsideAndOutside) {
  const Embedding embedding = embed(mesh_.V, mesh_.F, points_);
  EXPECT_EQ(embedding.weights.cols(), 3);
  EXPECT_LE((interpolate(embedding, mesh_.F, mesh_.V) - points_).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_LE((embedding.weights.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-14);
  for (Eigen::Index i = 0; i < points_.rows(); ++i) {
    const bool inside = winding_number({shapes::u_polygon()}, points_.row(i).transpose()) == 1;
    EXPECT_EQ(embedding.weights.row(i).minCoeff() >= -1e-13, inside) << points_.row(i);
  }
}

TEST_F(PlaneEmbedding, OutsidePointsTakeTheClosestTriangle) {
  const Embedding embedding = embed(mesh_.V, mesh_.F, points_);
  const auto distance = [&](const Eigen::Vector2d& p, Eigen::Index f) {
    std::vector<Points2> triangle(1);
    triangle[0].resize(3, 2);
    for (int k = 0; k < 3; ++k) triangle[0].row(k) = mesh_.V.row(mesh_.F(f, k));
    return winding_number(triangle, p) == 1 ? 0 : distance_to(triangle, p);
  };
  for (Eigen::Index i = 0; i < 200; ++i) {
    const Eigen::Vector2d p = points_.row(i);
    double nearest = 1e300;
    for (Eigen::Index f = 0; f < mesh_.F.rows(); ++f) nearest = std::min(nearest, distance(p, f));
    EXPECT_LE(distance(p, embedding.element[i]), nearest + 1e-9) << "point " << i;
  }
}

TEST_F(PlaneEmbedding, AffineMapsAreExact) {
  Eigen::Matrix2d linear;
  linear << 0.3, -1.2, 0.9, 0.5;
  EXPECT_LE((interpolate(embed(mesh_.V, mesh_.F, points_), mesh_.F, mesh_.V * linear) - points_ * linear)
                .cwiseAbs()
                .maxCoeff(),
            1e-12);
}

TEST_F(PlaneEmbedding, RejectsAMeshWithoutArea) {
  mesh_.V.col(1).setZero();
  EXPECT_THROW(embed(mesh_.V, mesh_.F, points_), Error);
}

}  // namespace
}  // namespace vivify::meshing
