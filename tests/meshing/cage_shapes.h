// Closed surfaces and tetrahedral meshes that the tests of cages, coordinates and embeddings share.
#pragma once

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "common/mesh.h"
#include "common/rng.h"

namespace vivify::meshing::shapes {

// Vertex x + 2 y + 4 z of the box between two corners; outward.
inline TriangleMesh box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  TriangleMesh mesh;
  mesh.V.resize(8, 3);
  for (int i = 0; i < 8; ++i) {
    mesh.V.row(i) << (i & 1 ? high : low)[0], (i & 2 ? high : low)[1], (i & 4 ? high : low)[2];
  }
  mesh.F.resize(12, 3);
  mesh.F << 0, 2, 3, 0, 3, 1, 4, 5, 6, 5, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 6, 0, 6, 2, 1, 3, 5,
      3, 7, 5;
  return mesh;
}

inline TriangleMesh octahedron() {
  TriangleMesh mesh;
  mesh.V.resize(6, 3);
  mesh.V << 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1;
  mesh.F.resize(8, 3);
  mesh.F << 0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5;
  return mesh;
}

// Every triangle split into four, `times` times.
inline TriangleMesh refined(TriangleMesh mesh, int times = 1) {
  for (; times > 0; --times) {
    std::vector<Eigen::RowVector3d> V;
    for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) V.push_back(mesh.V.row(v));
    std::map<std::pair<int, int>, int> middle;
    const auto halfway = [&](int a, int b) {
      const auto [it, inserted] = middle.emplace(std::minmax(a, b), static_cast<int>(V.size()));
      if (inserted) V.push_back(0.5 * (mesh.V.row(a) + mesh.V.row(b)));
      return it->second;
    };
    Triangles F(4 * mesh.F.rows(), 3);
    for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
      const int a = mesh.F(f, 0), b = mesh.F(f, 1), c = mesh.F(f, 2);
      const int ab = halfway(a, b), bc = halfway(b, c), ca = halfway(c, a);
      F.middleRows<4>(4 * f) << a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca;
    }
    mesh.F = F;
    mesh.V.resize(static_cast<Eigen::Index>(V.size()), 3);
    for (std::size_t v = 0; v < V.size(); ++v) mesh.V.row(static_cast<Eigen::Index>(v)) = V[v];
  }
  return mesh;
}

inline TriangleMesh sphere(const Eigen::RowVector3d& centre, double radius, int times = 3) {
  TriangleMesh mesh = refined(octahedron(), times);
  mesh.V.rowwise().normalize();
  mesh.V = ((radius * mesh.V).rowwise() + centre).eval();
  return mesh;
}

// Around the y axis.
inline TriangleMesh torus(double ring, double tube, int around = 48, int across = 20) {
  TriangleMesh mesh;
  mesh.V.resize(around * across, 3);
  mesh.F.resize(2 * around * across, 3);
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double a = 2 * std::numbers::pi * i / around, b = 2 * std::numbers::pi * j / across;
      const double r = ring + tube * std::cos(b);
      mesh.V.row(i * across + j) << r * std::cos(a), tube * std::sin(b), r * std::sin(a);
      const int i1 = (i + 1) % around, j1 = (j + 1) % across;
      const int p = i * across + j, q = i1 * across + j, r1 = i1 * across + j1, s = i * across + j1;
      mesh.F.row(2 * (i * across + j)) << p, r1, q;
      mesh.F.row(2 * (i * across + j) + 1) << p, s, r1;
    }
  }
  return mesh;
}

inline TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh mesh;
  mesh.V.resize(a.V.rows() + b.V.rows(), 3);
  mesh.V << a.V, b.V;
  mesh.F.resize(a.F.rows() + b.F.rows(), 3);
  mesh.F << a.F, b.F.array() + static_cast<int>(a.V.rows());
  return mesh;
}

// A polygon in the plane (counter-clockwise, with a triangulation) pushed out between z = 0 and z = depth.
inline TriangleMesh prism(const std::vector<std::array<double, 2>>& outline, const Triangles& triangulation,
                          double depth) {
  const int n = static_cast<int>(outline.size());
  TriangleMesh mesh;
  mesh.V.resize(2 * n, 3);
  mesh.F.resize(2 * triangulation.rows() + 2 * n, 3);
  for (int i = 0; i < n; ++i) {
    mesh.V.row(i) << outline[static_cast<std::size_t>(i)][0], outline[static_cast<std::size_t>(i)][1], 0;
    mesh.V.row(n + i) << mesh.V(i, 0), mesh.V(i, 1), depth;
    const int j = (i + 1) % n;
    mesh.F.row(2 * triangulation.rows() + 2 * i) << i, j, n + j;
    mesh.F.row(2 * triangulation.rows() + 2 * i + 1) << i, n + j, n + i;
  }
  mesh.F.topRows(triangulation.rows()) = triangulation.rowwise().reverse();
  mesh.F.middleRows(triangulation.rows(), triangulation.rows()) = triangulation.array() + n;
  return mesh;
}

// A U of width 3, height 3 and depth 1 with arms of width 1, closed below.
inline TriangleMesh u_shape() {
  const std::vector<std::array<double, 2>> outline = {{0, 0}, {3, 0}, {3, 3}, {2, 3},
                                                      {2, 1}, {1, 1}, {1, 3}, {0, 3}};
  Triangles triangulation(6, 3);
  triangulation << 0, 1, 4, 0, 4, 5, 1, 2, 3, 1, 3, 4, 0, 5, 6, 0, 6, 7;
  return prism(outline, triangulation, 1);
}

// The unit cube in n^3 cells of six tetrahedra each.
inline TetMesh cube_tets(int n) {
  TetMesh mesh;
  const auto id = [n](int i, int j, int k) { return (k * (n + 1) + j) * (n + 1) + i; };
  mesh.V.resize((n + 1) * (n + 1) * (n + 1), 3);
  mesh.T.resize(6 * n * n * n, 4);
  static constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  Eigen::Index row = 0;
  for (int k = 0; k <= n; ++k) {
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        mesh.V.row(id(i, j, k)) << double(i) / n, double(j) / n, double(k) / n;
        if (i == n || j == n || k == n) continue;
        for (int o = 0; o < 6; ++o) {
          std::array<int, 3> cell = {i, j, k};
          std::array<int, 4> corner = {id(i, j, k), 0, 0, 0};
          for (std::size_t step = 0; step < 3; ++step) {
            ++cell[static_cast<std::size_t>(kOrders[o][step])];
            corner[step + 1] = id(cell[0], cell[1], cell[2]);
          }
          if (o >= 3) std::swap(corner[2], corner[3]);
          mesh.T.row(row++) << corner[0], corner[1], corner[2], corner[3];
        }
      }
    }
  }
  return mesh;
}

inline Points random_points(int count, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                            std::uint64_t seed) {
  CounterRng rng(seed);
  Points points(count, 3);
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k) points(i, k) = rng.uniform(low[k], high[k]);
  }
  return points;
}

}  // namespace vivify::meshing::shapes
