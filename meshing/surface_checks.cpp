#include "meshing/surface_checks.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

namespace vivify::meshing {

std::string topology_problem(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, int> face_of;  // directed edge -> face to its left
  const auto edge_text = [](int a, int b) { return "edge " + std::to_string(a) + "-" + std::to_string(b); };
  for (int f = 0; f < mesh.F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.F(f, k), b = mesh.F(f, (k + 1) % 3);
      if (a == b) return "face " + std::to_string(f) + " uses vertex " + std::to_string(a) + " twice";
      if (!face_of.emplace(std::pair(a, b), f).second) {
        return edge_text(a, b) + " belongs to more than two faces, or its faces are oriented differently";
      }
    }
  }
  int open = 0;
  std::string example;
  for (const auto& [edge, face] : face_of) {
    if (face_of.contains({edge.second, edge.first})) continue;
    if (open++ == 0) example = edge_text(edge.first, edge.second);
  }
  if (open > 0) return "it is open at " + std::to_string(open) + " edges, for example " + example;

  // The faces around each vertex must make one fan.
  std::vector<int> corners(static_cast<std::size_t>(mesh.V.rows()), 0), first(corners.size(), -1);
  for (int f = 0; f < mesh.F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(mesh.F(f, k));
      ++corners[v];
      if (first[v] < 0) first[v] = f;
    }
  }
  for (std::size_t v = 0; v < corners.size(); ++v) {
    int face = first[v], fan = 0;
    if (face < 0) return "vertex " + std::to_string(v) + " belongs to no face";
    do {
      const auto row = mesh.F.row(face);
      const int k = static_cast<int>(std::find(row.begin(), row.end(), static_cast<int>(v)) - row.begin());
      face = face_of.at({row[k], row[(k + 2) % 3]});  // across the edge that enters v
      ++fan;
    } while (face != first[v] && fan <= corners[v]);
    if (fan != corners[v]) return "its parts touch only in vertex " + std::to_string(v);
  }
  return {};
}

int component_count(const TriangleMesh& mesh) {
  std::vector<int> parent(static_cast<std::size_t>(mesh.V.rows()));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int v) {
    while (parent[static_cast<std::size_t>(v)] != v) v = parent[static_cast<std::size_t>(v)];
    return v;
  };
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    for (int k = 1; k < 3; ++k) {
      const int a = root(mesh.F(f, 0)), b = root(mesh.F(f, k));
      parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  }
  int count = 0;
  std::vector<char> used(parent.size(), 0);
  for (Eigen::Index i = 0; i < mesh.F.size(); ++i) used[static_cast<std::size_t>(mesh.F.data()[i])] = 1;
  for (std::size_t v = 0; v < parent.size(); ++v) count += used[v] && parent[v] == static_cast<int>(v);
  return count;
}

TriangleMesh without_duplicates(const TriangleMesh& mesh) {
  std::map<std::array<double, 3>, int> seen;
  std::vector<int> row(static_cast<std::size_t>(mesh.V.rows()));
  TriangleMesh result;
  result.V.resize(mesh.V.rows(), 3);
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
    const auto [it, inserted] =
        seen.emplace(std::array{mesh.V(v, 0), mesh.V(v, 1), mesh.V(v, 2)}, static_cast<int>(seen.size()));
    if (inserted) result.V.row(it->second) = mesh.V.row(v);
    row[static_cast<std::size_t>(v)] = it->second;
  }
  result.V.conservativeResize(static_cast<Eigen::Index>(seen.size()), 3);
  result.F = mesh.F.unaryExpr([&](int v) { return row[static_cast<std::size_t>(v)]; });
  return result;
}

}  // namespace vivify::meshing
