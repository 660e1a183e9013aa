#include "meshing/shell_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "common/error.h"
#include "meshing/closest_point.h"
#include "meshing/quality.h"
#include "tests/meshing/solids.h"

namespace vivify::meshing {
namespace {

using ::testing::HasSubstr;

// An open sheet over the unit square, bent along x.
TriangleMesh sheet(int n) {
  TriangleMesh mesh;
  mesh.V.resize((n + 1) * (n + 1), 3);
  mesh.F.resize(2 * n * n, 3);
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const double x = static_cast<double>(i) / n, y = static_cast<double>(j) / n;
      mesh.V.row(i * (n + 1) + j) << x, y, 0.3 * std::sin(3 * x);
    }
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const int a = i * (n + 1) + j, b = a + n + 1;
      mesh.F.row(2 * (i * n + j)) << a, b, b + 1;
      mesh.F.row(2 * (i * n + j) + 1) << a, b + 1, a + 1;
    }
  }
  return mesh;
}

// Edges of one face only; every other edge has two faces that run through it in opposite directions.
int border_edges(const Triangles& F) {
  std::map<std::pair<int, int>, int> along;
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) ++along[{F(f, k), F(f, (k + 1) % 3)}];
  }
  int borders = 0;
  for (const auto& [edge, count] : along) {
    EXPECT_EQ(count, 1) << "not oriented alike";
    borders += !along.contains({edge.second, edge.first});
  }
  return borders;
}

double largest_distance(const Points& V, const TriangleMesh& from) {
  const ClosestPoint closest(from);
  double largest = 0;
  for (Eigen::Index v = 0; v < V.rows(); ++v) largest = std::max(largest, closest(V.row(v)).distance);
  return largest;
}

std::string message_of(const TriangleMesh& mesh, int vertices = 0) {
  try {
    shell_mesh(mesh, vertices);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::geometry);
    return error.what();
  }
  return "no error";
}

TEST(ShellMesh, StaysAsItIsWithoutANumberOrWithItsOwn) {
  const TriangleMesh input = sheet(6);
  for (const int vertices : {0, 49}) {
    const ShellMesh shell = shell_mesh(input, vertices);
    EXPECT_EQ(shell.mesh.V, input.V);
    EXPECT_EQ(shell.mesh.F, input.F);
    EXPECT_TRUE(shell.notes.empty());
    EXPECT_GT(shell.min_angle, 20);
    EXPECT_LT(shell.min_angle, 46);
  }
}

TEST(ShellMesh, OpenSheetCoarserAndFiner) {
  const TriangleMesh input = sheet(24);  // 625 vertices
  for (const int vertices : {60, 200, 1500}) {
    SCOPED_TRACE(vertices);
    const ShellMesh shell = shell_mesh(input, vertices);
    EXPECT_NEAR(static_cast<double>(shell.mesh.V.rows()), vertices, 0.15 * vertices);
    EXPECT_TRUE(is_manifold(shell.mesh.F));
    EXPECT_GT(border_edges(shell.mesh.F), 0);
    EXPECT_EQ(euler_characteristic(shell.mesh.F), 1);
    EXPECT_GT(shell.min_angle, 12);
    EXPECT_LT(largest_distance(shell.mesh.V, input), 1e-3);
    EXPECT_LT(largest_distance(input.V, shell.mesh), 0.03);
    for (const Eigen::Index corner : {0, 24, 600, 624}) {
      EXPECT_LT((shell.mesh.V.rowwise() - input.V.row(corner)).rowwise().norm().minCoeff(), 1e-12);
    }
  }
}

TEST(ShellMesh, ClosedSurfacesFaceOutward) {
  const ShellMesh shell = shell_mesh(shapes::turned(shapes::sphere({1, 2, 3}, 0.5, 4)), 300);
  EXPECT_NEAR(static_cast<double>(shell.mesh.V.rows()), 300, 45);
  EXPECT_TRUE(is_closed_oriented(shell.mesh.F));
  EXPECT_GT(signed_volume(shell.mesh), 0.47);
  EXPECT_GT(shell.min_angle, 20);
}

TEST(ShellMesh, CreasesOfABoxStay) {
  const ShellMesh shell = shell_mesh(shapes::open_box(), 250);
  EXPECT_NEAR(static_cast<double>(shell.mesh.V.rows()), 250, 38);
  EXPECT_LT(largest_distance(shapes::open_box().V, shell.mesh), 1e-9);
  EXPECT_LT(largest_distance(shell.mesh.V, shapes::open_box()), 1e-6);
}

TEST(ShellMesh, RepairsSeamsAndMixedOrientation) {
  TriangleMesh input = sheet(4);
  // Every face gets vertices of its own, and every third one is turned.
  TriangleMesh soup;
  soup.V.resize(3 * input.F.rows() + 1, 3);
  soup.F.resize(input.F.rows() + 1, 3);
  for (int f = 0; f < input.F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) soup.V.row(3 * f + k) = input.V.row(input.F(f, k));
    soup.F.row(f) << 3 * f, 3 * f + (f % 3 == 2 ? 2 : 1), 3 * f + (f % 3 == 2 ? 1 : 2);
  }
  soup.V.row(soup.V.rows() - 1) << 9, 9, 9;  // belongs to no face with an area
  soup.F.row(soup.F.rows() - 1) << 0, 1, 1;
  const ShellMesh shell = shell_mesh(soup, 0);
  EXPECT_EQ(shell.mesh.V.rows(), 25);
  EXPECT_EQ(shell.mesh.F.rows(), 32);
  EXPECT_EQ(border_edges(shell.mesh.F), 16);
  EXPECT_EQ(shell.notes.size(), 3U);
}

TEST(ShellMesh, WhatIsNoShellIsNamed) {
  EXPECT_THAT(message_of(shapes::moebius()), HasSubstr("it has one side only"));
  TriangleMesh fin = sheet(1);
  fin.V.conservativeResize(5, 3);
  fin.V.row(4) << 0, 0, 1;
  fin.F.conservativeResize(3, 3);
  fin.F.row(2) << 0, 3, 4;
  EXPECT_THAT(message_of(fin), HasSubstr("3 faces meet at the edge from (0, 0, 0) to (1, 1, "));
  TriangleMesh touching = shapes::joined(shapes::single_triangle(), shapes::single_triangle());
  touching.V.bottomRows(3) = -touching.V.bottomRows(3);
  EXPECT_THAT(message_of(touching), HasSubstr("touch only in the vertex at (0, 0, 0)"));
  EXPECT_THAT(message_of(TriangleMesh()), HasSubstr("has no face"));
  TriangleMesh broken = sheet(1);
  broken.V(2, 1) = std::nan("");
  EXPECT_THAT(message_of(broken), HasSubstr("not finite"));
  TriangleMesh flat = shapes::single_triangle();
  flat.V.row(2) = 2 * flat.V.row(1);
  EXPECT_THAT(message_of(flat), HasSubstr("no face with an area"));
  EXPECT_THAT(message_of(shapes::unit_box(), 5),
              HasSubstr("cannot be meshed with 5 vertices; the nearest is"));
}

TEST(ShellMesh, SameBitsOnEveryRun) {
  const ShellMesh one = shell_mesh(sheet(12), 80), two = shell_mesh(sheet(12), 80);
  EXPECT_EQ(one.mesh.V, two.mesh.V);
  EXPECT_EQ(one.mesh.F, two.mesh.F);
}

}  // namespace
}  // namespace vivify::meshing
