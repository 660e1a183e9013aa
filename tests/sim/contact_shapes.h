// Surfaces for the tests of contact between bodies.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "common/rng.h"
#include "sim/contact/contact_surface.h"

namespace vivify::sim {

// A triangle surface whose points are the vertices of a simulation mesh: x is V, flat.
inline ContactSurface surface_of(const Points& V, const RowMatrixXi& F, double radius = 0) {
  ContactSurface surface;
  surface.points.vertices = Eigen::VectorXi::LinSpaced(V.rows(), 0, static_cast<int>(V.rows()) - 1);
  surface.points.weights.setOnes(V.rows(), 1);
  surface.rest = V;
  surface.faces = F;
  surface.edges = edges_of(F);
  surface.radius = radius;
  surface.two_sided = radius > 0;
  return surface;
}

// A polyline or polygon of the plane.
inline ContactSurface planar_surface(const Points2& V, bool closed, double radius = 0) {
  ContactSurface surface;
  const auto count = static_cast<int>(V.rows());
  surface.points.dimension = 2;
  surface.points.vertices = Eigen::VectorXi::LinSpaced(count, 0, count - 1);
  surface.points.weights.setOnes(count, 1);
  surface.rest.setZero(count, 3);
  surface.rest.leftCols(2) = V;
  surface.edges.resize(closed ? count : count - 1, 2);
  for (int e = 0; e < surface.edges.rows(); ++e) surface.edges.row(e) << e, (e + 1) % count;
  surface.radius = radius;
  surface.two_sided = radius > 0;
  return surface;
}

inline Eigen::VectorXd flat_points(const Points& V) { return V.reshaped<Eigen::RowMajor>(); }

// Two surfaces without a common point.
struct Shape {
  Points V;
  RowMatrixXi F;
  Shape moved(const Eigen::Vector3d& shift, const Eigen::Matrix3d& turn = Eigen::Matrix3d::Identity()) const {
    return {(V * turn.transpose()).rowwise() + shift.transpose(), F};
  }
};

// Cube of edge 2 about the origin.
inline Shape cube() {
  Shape shape{Points(8, 3), RowMatrixXi(12, 3)};
  for (int i = 0; i < 8; ++i) shape.V.row(i) << (i & 1 ? 1 : -1), (i & 2 ? 1 : -1), (i & 4 ? 1 : -1);
  shape.F << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3,
      5, 3, 7, 5;
  return shape;
}

// Regular tetrahedron with corners on the unit sphere.
inline Shape tetrahedron() {
  Shape shape{Points(4, 3), RowMatrixXi(4, 3)};
  shape.V << 1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1;
  shape.V /= std::numbers::sqrt3;
  shape.F << 1, 3, 2, 0, 2, 3, 0, 3, 1, 0, 1, 2;
  return shape;
}

// Sphere of radius 1: an icosahedron, each face cut into four `times` times.
inline Shape sphere(int times) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  std::vector<Eigen::Vector3d> V = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                    {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                    {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  std::vector<std::array<int, 3>> F = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                       {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                       {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                       {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int round = 0; round < times; ++round) {
    std::map<std::pair<int, int>, int> middle;
    std::vector<std::array<int, 3>> finer;
    const auto between = [&](int a, int b) {
      const auto [it, inserted] = middle.try_emplace(std::minmax(a, b), static_cast<int>(V.size()));
      if (inserted) V.push_back((V[a] + V[b]) / 2);
      return it->second;
    };
    for (const auto& [a, b, c] : F) {
      const int ab = between(a, b), bc = between(b, c), ca = between(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    F = finer;
  }
  Shape shape{Points(V.size(), 3), RowMatrixXi(F.size(), 3)};
  for (std::size_t i = 0; i < V.size(); ++i) shape.V.row(i) = V[i].normalized().transpose();
  for (std::size_t f = 0; f < F.size(); ++f) shape.F.row(f) << F[f][0], F[f][1], F[f][2];
  return shape;
}

// A sphere whose points lie at random radii: closed, and nowhere convex.
inline Shape bumpy_sphere(int times, double low, double high, std::uint64_t seed) {
  Shape shape = sphere(times);
  CounterRng rng(seed);
  for (Eigen::Index i = 0; i < shape.V.rows(); ++i) shape.V.row(i) *= rng.uniform(low, high);
  return shape;
}

// A sheet of nx by nz squares of edge `cell` in the plane y = 0, its corner at the origin.
inline Shape sheet(int nx, int nz, double cell) {
  Shape shape{Points((nx + 1) * (nz + 1), 3), RowMatrixXi(2 * nx * nz, 3)};
  for (int i = 0; i <= nx; ++i) {
    for (int k = 0; k <= nz; ++k) shape.V.row(i * (nz + 1) + k) << i * cell, 0, k * cell;
  }
  int f = 0;
  for (int i = 0; i < nx; ++i) {
    for (int k = 0; k < nz; ++k) {
      const int a = i * (nz + 1) + k, b = a + nz + 1;
      shape.F.row(f++) << a, a + 1, b;
      shape.F.row(f++) << b, a + 1, b + 1;
    }
  }
  return shape;
}

inline Eigen::Vector3d random_point(double half, CounterRng& rng) {
  const double x = rng.uniform(-half, half), y = rng.uniform(-half, half), z = rng.uniform(-half, half);
  return {x, y, z};
}

}  // namespace vivify::sim
