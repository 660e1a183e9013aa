// Surfaces of the four kinds of bodies.
#include "sim/contact/contact_surface.h"

#include <gtest/gtest.h>

#include "common/error.h"
#include "tests/sim/contact_shapes.h"

namespace vivify::sim {
namespace {

// A ball: its middle, the first vertex, joined to all faces of a sphere.
SimMesh ball() {
  const Shape shape = sphere(1);
  SimMesh mesh{RowMatrixXd::Zero(shape.V.rows() + 1, 3), RowMatrixXi(shape.F.rows(), 4)};
  mesh.V.bottomRows(shape.V.rows()) = shape.V;
  mesh.E.col(0).setZero();
  mesh.E.rightCols(3) = shape.F.array() + 1;
  return mesh;
}

TEST(ContactSurface, OfASolidIsItsClosedBoundary) {
  const SimMesh mesh = ball();
  const ContactSurface surface = boundary_of(mesh);
  EXPECT_FALSE(surface.two_sided);
  EXPECT_EQ(surface.radius, 0);
  ASSERT_EQ(surface.points.size(), 42);  // not the middle
  EXPECT_EQ(surface.faces.rows(), 80);
  EXPECT_EQ(surface.edges.rows(), 120);
  const TriangleMesh closed{surface.rest, Triangles(surface.faces), {}, {}, {}};
  EXPECT_NEAR(signed_volume(closed), element_sizes(mesh).sum(), 1e-12);
  const Eigen::VectorXd x = mesh.V.reshaped<Eigen::RowMajor>();
  for (int i = 0; i < surface.points.size(); ++i) {
    EXPECT_EQ(surface.points.position(i, x), surface.rest.row(i).transpose());
  }
}

TEST(ContactSurface, OfAFlatSolidIsItsRimCounterClockwise) {
  SimMesh mesh;  // a square of four triangles about its middle
  mesh.V.resize(5, 2);
  mesh.V << 0, 0, 0.5, 0.5, 1, 0, 1, 1, 0, 1;
  mesh.E.resize(4, 3);
  mesh.E << 0, 2, 1, 2, 3, 1, 3, 4, 1, 4, 0, 1;
  const ContactSurface surface = boundary_of(mesh);
  EXPECT_TRUE(surface.planar());
  EXPECT_FALSE(surface.two_sided);
  EXPECT_EQ(surface.points.size(), 4);
  ASSERT_EQ(surface.edges.rows(), 4);
  EXPECT_EQ(surface.faces.rows(), 0);
  double area = 0;
  for (int e = 0; e < 4; ++e) {
    const auto a = surface.rest.row(surface.edges(e, 0)), b = surface.rest.row(surface.edges(e, 1));
    area += (a[0] * b[1] - a[1] * b[0]) / 2;
  }
  EXPECT_NEAR(area, 1, 1e-15);
}

SimMesh shell() {
  const Shape shape = sheet(2, 3, 0.1);
  return {shape.V, shape.F};
}

SimMesh rod() {
  SimMesh mesh{RowMatrixXd(3, 2), RowMatrixXi(2, 2)};
  mesh.V << 0, 0, 1, 0, 2, 1;
  mesh.E << 0, 1, 1, 2;
  return mesh;
}

TEST(ContactSurface, OfShellsAndRodsIsTheWholeBody) {
  const ContactSurface sheet = boundary_of(shell(), 0.01), line = boundary_of(rod(), 0.02);
  EXPECT_TRUE(sheet.two_sided && line.two_sided);
  EXPECT_EQ(sheet.radius, 0.01);
  EXPECT_EQ(sheet.faces, shell().E);
  EXPECT_EQ(sheet.points.size(), 12);
  EXPECT_EQ(line.edges, rod().E);
  EXPECT_TRUE(line.planar());
  EXPECT_EQ(line.rest.row(2), Eigen::RowVector3d(2, 1, 0));
}

TEST(ContactSurface, ShellsAndRodsNeedAThickness) {
  EXPECT_THROW(boundary_of(shell(), 0), Error);
  EXPECT_THROW(boundary_of(rod(), -0.1), Error);
  EXPECT_THROW(boundary_of(rod(), NAN), Error);
  EXPECT_THROW(boundary_of({RowMatrixXd(3, 3), RowMatrixXi(0, 4)}), Error);
}

}  // namespace
}  // namespace vivify::sim
