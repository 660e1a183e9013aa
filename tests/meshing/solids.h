// Broken and unusual surfaces for the tests of repair and tetrahedralization.
#pragma once

#include <cmath>
#include <numbers>

#include "common/mesh.h"
#include "tests/meshing/cage_shapes.h"

namespace vivify::meshing::shapes {

inline TriangleMesh unit_box() { return box({0, 0, 0}, {1, 1, 1}); }

// The unit box without its top (two triangles at z = 1).
inline TriangleMesh open_box() {
  TriangleMesh mesh = unit_box();
  Triangles F(10, 3);
  Eigen::Index row = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    if (mesh.V(mesh.F(f, 0), 2) + mesh.V(mesh.F(f, 1), 2) + mesh.V(mesh.F(f, 2), 2) < 3)
      F.row(row++) = mesh.F.row(f);
  }
  mesh.F = F;
  return mesh;
}

inline TriangleMesh turned(TriangleMesh mesh) {
  mesh.F.col(1).swap(mesh.F.col(2));
  return mesh;
}

inline TriangleMesh scaled(TriangleMesh mesh, double factor,
                           const Eigen::RowVector3d& shift = Eigen::RowVector3d::Zero()) {
  mesh.V = ((factor * mesh.V).rowwise() + shift).eval();
  return mesh;
}

// A band with a half turn: open and not orientable.
inline TriangleMesh moebius(int around = 48) {
  TriangleMesh mesh;
  mesh.V.resize(2 * around, 3);
  mesh.F.resize(2 * around, 3);
  for (int i = 0; i < around; ++i) {
    const double a = 2 * std::numbers::pi * i / around;
    for (int side = 0; side < 2; ++side) {
      const double w = side == 0 ? -0.3 : 0.3, r = 1 + w * std::cos(a / 2);
      mesh.V.row(2 * i + side) << r * std::cos(a), w * std::sin(a / 2), r * std::sin(a);
    }
    const bool last = i + 1 == around;
    const int p = 2 * i, q = 2 * i + 1, r = last ? 1 : 2 * i + 2, s = last ? 0 : 2 * i + 3;
    mesh.F.row(2 * i) << p, r, q;
    mesh.F.row(2 * i + 1) << q, r, s;
  }
  return mesh;
}

inline TriangleMesh single_triangle() {
  TriangleMesh mesh;
  mesh.V.resize(3, 3);
  mesh.V << 0, 0, 0, 1, 0, 0, 0, 1, 0;
  mesh.F.resize(1, 3);
  mesh.F << 0, 1, 2;
  return mesh;
}

// A cup: a solid of revolution with a wall, a cavity that is open above, and a flat foot at y = 0.
inline TriangleMesh cup(int around = 96) {
  const std::vector<std::array<double, 2>> corners = {{0, 0},       {0.28, 0},    {0.3, 0.03}, {0.4, 0.2},
                                                      {0.48, 0.7},  {0.46, 0.72}, {0.42, 0.7}, {0.34, 0.22},
                                                      {0.25, 0.12}, {0, 0.1}};
  std::vector<std::array<double, 2>> profile;  // radius, height
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const double dr = corners[i + 1][0] - corners[i][0], dy = corners[i + 1][1] - corners[i][1];
    const int pieces = std::max(1, static_cast<int>(std::hypot(dr, dy) / 0.02));
    for (int k = 0; k < pieces; ++k)
      profile.push_back({corners[i][0] + dr * k / pieces, corners[i][1] + dy * k / pieces});
  }
  profile.push_back(corners.back());
  const int rings = static_cast<int>(profile.size()) - 2;
  TriangleMesh mesh;
  mesh.V.resize(2 + rings * around, 3);
  mesh.V.row(0) << 0, profile.front()[1], 0;
  mesh.V.row(1) << 0, profile.back()[1], 0;
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < around; ++j) {
      const double a = 2 * std::numbers::pi * j / around;
      const auto& [r, y] = profile[static_cast<std::size_t>(i + 1)];
      mesh.V.row(2 + i * around + j) << r * std::cos(a), y, r * std::sin(a);
    }
  }
  mesh.F.resize(2 * rings * around, 3);
  Eigen::Index row = 0;
  for (int j = 0; j < around; ++j) {
    const int k = (j + 1) % around, last = 2 + (rings - 1) * around;
    mesh.F.row(row++) << 0, 2 + j, 2 + k;
    mesh.F.row(row++) << 1, last + k, last + j;
    for (int i = 0; i + 1 < rings; ++i) {
      const int a = 2 + i * around + j, b = 2 + i * around + k, c = a + around, d = b + around;
      mesh.F.row(row++) << a, c, b;
      mesh.F.row(row++) << b, c, d;
    }
  }
  return mesh;
}

}  // namespace vivify::meshing::shapes
