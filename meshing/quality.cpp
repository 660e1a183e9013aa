#include "meshing/quality.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

namespace vivify::meshing {
namespace {

using Edge = std::pair<int, int>;

int find_root(std::vector<int>& parent, int v) {
  while (parent[static_cast<std::size_t>(v)] != v) {
    int& up = parent[static_cast<std::size_t>(v)];
    up = parent[static_cast<std::size_t>(up)];
    v = up;
  }
  return v;
}

template <class Elements>
int count_parts(const Elements& elements) {
  if (elements.rows() == 0) return 0;
  std::vector<int> parent(static_cast<std::size_t>(elements.maxCoeff()) + 1);
  std::iota(parent.begin(), parent.end(), 0);
  std::vector<char> used(parent.size(), 0);
  for (Eigen::Index e = 0; e < elements.rows(); ++e) {
    for (Eigen::Index k = 0; k < elements.cols(); ++k) {
      used[static_cast<std::size_t>(elements(e, k))] = 1;
      const int a = find_root(parent, elements(e, 0)), b = find_root(parent, elements(e, k));
      if (a != b) parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  }
  int parts = 0;
  for (std::size_t v = 0; v < parent.size(); ++v) {
    if (used[v] != 0 && parent[v] == static_cast<int>(v)) ++parts;
  }
  return parts;
}

template <class Elements>
void drop_unused(Points& V, Elements& elements) {
  std::vector<int> index(static_cast<std::size_t>(V.rows()), -1);
  for (Eigen::Index i = 0; i < elements.size(); ++i) index[static_cast<std::size_t>(elements.data()[i])] = 0;
  int count = 0;
  for (Eigen::Index v = 0; v < V.rows(); ++v) {
    int& id = index[static_cast<std::size_t>(v)];
    if (id < 0) continue;
    id = count++;
    V.row(id) = V.row(v).eval();
  }
  V.conservativeResize(count, 3);
  for (Eigen::Index i = 0; i < elements.size(); ++i) {
    elements.data()[i] = index[static_cast<std::size_t>(elements.data()[i])];
  }
}

}  // namespace

std::array<double, 6> dihedral_angles(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                      const Eigen::Vector3d& c, const Eigen::Vector3d& d) {
  const std::array<const Eigen::Vector3d*, 4> x = {&a, &b, &c, &d};
  constexpr int kEdges[6][4] = {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2},
                                {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}};
  std::array<double, 6> angles = {};
  for (std::size_t e = 0; e < 6; ++e) {
    const Eigen::Vector3d& o = *x[static_cast<std::size_t>(kEdges[e][0])];
    const Eigen::Vector3d axis = *x[static_cast<std::size_t>(kEdges[e][1])] - o;
    const Eigen::Vector3d m = axis.cross(*x[static_cast<std::size_t>(kEdges[e][2])] - o);
    const Eigen::Vector3d n = axis.cross(*x[static_cast<std::size_t>(kEdges[e][3])] - o);
    angles[e] = std::atan2(m.cross(n).norm(), m.dot(n)) * 180 / std::numbers::pi;
  }
  return angles;
}

AngleRange dihedral_range(const TetMesh& mesh) {
  AngleRange range;
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t) {
    const auto angles = dihedral_angles(mesh.V.row(mesh.T(t, 0)), mesh.V.row(mesh.T(t, 1)),
                                        mesh.V.row(mesh.T(t, 2)), mesh.V.row(mesh.T(t, 3)));
    for (const double angle : angles) {
      range.min = std::min(range.min, angle);
      range.max = std::max(range.max, angle);
    }
  }
  return range;
}

int component_count(const Triangles& F) { return count_parts(F); }
int component_count(const Tetrahedra& T) { return count_parts(T); }

bool is_closed_oriented(const Triangles& F) {
  std::map<Edge, int> balance;
  std::map<Edge, int> uses;
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int a = F(f, k), b = F(f, (k + 1) % 3);
      const Edge edge = std::minmax(a, b);
      balance[edge] += a < b ? 1 : -1;
      ++uses[edge];
    }
  }
  return F.rows() > 0 &&
         std::all_of(balance.begin(), balance.end(), [](const auto& e) { return e.second == 0; }) &&
         std::all_of(uses.begin(), uses.end(), [](const auto& e) { return e.second == 2; });
}

bool is_manifold(const Triangles& F) {
  std::map<Edge, int> uses;
  std::map<int, std::vector<Edge>> links;  // vertex -> opposite edges
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int a = F(f, k), b = F(f, (k + 1) % 3), c = F(f, (k + 2) % 3);
      if (++uses[std::minmax(a, b)] > 2) return false;
      links[a].push_back({b, c});
    }
  }
  for (const auto& [vertex, link] :
       links) {  // the link must be one path or one cycle: connected, degrees at most 2
    std::map<int, std::vector<int>> neighbours;
    for (const auto& [b, c] : link) {
      neighbours[b].push_back(c);
      neighbours[c].push_back(b);
    }
    std::vector<int> stack = {link.front().first};
    std::map<int, bool> seen = {{stack.front(), true}};
    while (!stack.empty()) {
      const int v = stack.back();
      stack.pop_back();
      for (const int n : neighbours[v]) {
        if (seen.emplace(n, true).second) stack.push_back(n);
      }
    }
    if (seen.size() != neighbours.size()) return false;
    for (const auto& [v, near] : neighbours) {
      if (near.size() > 2) return false;
    }
  }
  return true;
}

int euler_characteristic(const Triangles& F) {
  std::map<Edge, int> edges;
  std::map<int, int> vertices;
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      ++edges[std::minmax(F(f, k), F(f, (k + 1) % 3))];
      ++vertices[F(f, k)];
    }
  }
  return static_cast<int>(vertices.size()) - static_cast<int>(edges.size()) + static_cast<int>(F.rows());
}

void drop_unused_vertices(TriangleMesh& mesh) { drop_unused(mesh.V, mesh.F); }
void drop_unused_vertices(TetMesh& mesh) { drop_unused(mesh.V, mesh.T); }

}  // namespace vivify::meshing
