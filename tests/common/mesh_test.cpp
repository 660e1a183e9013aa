#include "common/mesh.h"

#include <gtest/gtest.h>

#include "common/error.h"

namespace vivify {
namespace {

// The unit cube cut into six tetrahedra around its diagonal.
TetMesh cube() {
  TetMesh mesh;
  mesh.V.resize(8, 3);
  for (int v = 0; v < 8; ++v) mesh.V.row(v) << (v & 1), (v >> 1 & 1), (v >> 2 & 1);
  mesh.T.resize(6, 4);
  mesh.T << 0, 1, 3, 7, 0, 3, 2, 7, 0, 2, 6, 7, 0, 6, 4, 7, 0, 4, 5, 7, 0, 5, 1, 7;
  return mesh;
}

TEST(Mesh, VolumesOfTheCubeAddUp) {
  const TetMesh mesh = cube();
  const Eigen::VectorXd volumes = tet_volumes(mesh);
  EXPECT_GT(volumes.minCoeff(), 0);
  EXPECT_NEAR(volumes.sum(), 1, 1e-15);
  TriangleMesh surface;
  surface.V = mesh.V;
  surface.F = boundary_faces(mesh);
  EXPECT_EQ(surface.F.rows(), 12);
  EXPECT_NEAR(signed_volume(surface), 1, 1e-15);
  surface.V.rowwise() += Eigen::RowVector3d(3, -5, 7);
  EXPECT_NEAR(signed_volume(surface), 1, 1e-13);
  surface.F.col(1).swap(surface.F.col(2));
  EXPECT_NEAR(signed_volume(surface), -1, 1e-13);
}

TEST(Mesh, LumpedMassIsTheMassOfTheBody) {
  const SimMesh mesh = sim_mesh(cube());
  const Eigen::VectorXd mass = lumped_mass(mesh, 700 * element_sizes(mesh));
  EXPECT_NEAR(mass.sum(), 700, 1e-10);
  EXPECT_NEAR(mass(0), 700 / 4.0, 1e-10);   // on the diagonal: in all six
  EXPECT_NEAR(mass(1), 700 / 12.0, 1e-10);  // in two
}

TEST(Mesh, SizesOfElements) {
  SimMesh plane;
  plane.V.resize(3, 2);
  plane.V << 0, 0, 3, 0, 0, 4;
  plane.E.resize(2, 3);
  plane.E << 0, 1, 2, 0, 2, 1;
  EXPECT_EQ(element_sizes(plane), Eigen::Vector2d(6, -6));
  SimMesh rod = plane;
  rod.E.resize(1, 2);
  rod.E << 1, 2;
  EXPECT_EQ(element_sizes(rod)[0], 5);
  EXPECT_EQ(lumped_mass(rod, Eigen::VectorXd::Constant(1, 8.0)), Eigen::Vector3d(0, 4, 4));
  SimMesh shell;
  shell.V = Eigen::MatrixXd::Identity(3, 3);
  shell.E.resize(1, 3);
  shell.E << 0, 2, 1;
  EXPECT_NEAR(element_sizes(shell)[0], std::sqrt(3) / 2, 1e-15);
}

TEST(Mesh, NormalsOfTheCubePointOutward) {
  const TetMesh mesh = cube();
  const Points N = vertex_normals(mesh.V, boundary_faces(mesh));
  for (int v = 0; v < 8; ++v) {
    EXPECT_NEAR(N.row(v).norm(), 1, 1e-14);
    EXPECT_GT(N.row(v).dot(mesh.V.row(v) - Eigen::RowVector3d(0.5, 0.5, 0.5)), 0.5);
  }
}

TEST(Mesh, BoundingBox) {
  const Box box = bounding_box(cube().V);
  EXPECT_EQ(box.min, Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(box.max, Eigen::Vector3d(1, 1, 1));
  EXPECT_THROW(bounding_box(Points(0, 3)), Error);
}

}  // namespace
}  // namespace vivify
