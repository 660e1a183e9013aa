#include "meshing/embedding.h"

#include <gtest/gtest.h>

#include "common/error.h"
#include "common/parallel.h"
#include "tests/meshing/cage_shapes.h"

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
    chosen.T = mesh.T.row(embedding.tet[i]);
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
  EXPECT_EQ(embedding.tet[0], 1);
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
  EXPECT_EQ(one.tet, two.tet);
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

}  // namespace
}  // namespace vivify::meshing
