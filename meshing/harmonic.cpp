#include "meshing/harmonic.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/error.h"
#include "common/parallel.h"
#include "common/text.h"
#include "meshing/backends/tetgen.h"
#include "meshing/embedding.h"
#include "meshing/enclosure.h"
#include "meshing/laplace.h"

namespace vivify::meshing {
namespace {

// Nearer to the cage than this part of its diagonal, a point would spoil the tetrahedra.
constexpr double kLeastClearance = 1e-7;

// Bound on the volume of a tetrahedron, times interior nodes, over the volume of the cage (measured on a cube
// and an L).
constexpr double kVolumePerUnknown = 0.27;

void check_points(const TriangleMesh& cage, const Points& points, double diagonal) {
  const std::vector<int> bad = points_not_inside(cage, points, kLeastClearance * diagonal);
  if (bad.empty()) return;
  throw Error(ErrorKind::geometry,
              std::to_string(bad.size()) + " of " + std::to_string(points.rows()) +
                  " points are not strictly inside the cage: " + list_some("points", bad),
              "enlarge the cage there");
}

// Tetrahedra of the cage with the points as nodes. Refinement bounds the volume of a tetrahedron; a Delaunay
// refinement makes about one interior node for every kVolumePerUnknown of the bound.
TetgenOutput mesh_cage(const TriangleMesh& cage, const Points& points, double diagonal, int unknowns) {
  TetgenInput input;
  input.points.resize(cage.V.rows() + points.rows(), 3);
  input.points << cage.V, points;
  input.facets = cage.F;
  const double bound = kVolumePerUnknown * signed_volume(cage) / std::pow(diagonal, 3) / unknowns;
  return run_tetgen(input, "pq1.414a" + number_text(bound));
}

Eigen::Vector3d barycentric(const Eigen::Vector3d& q, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                            const Eigen::Vector3d& c) {
  Eigen::Matrix<double, 3, 2> edges;
  edges << b - a, c - a;
  const Eigen::Vector2d w = edges.colPivHouseholderQr().solve(q - a);
  return {1 - w.sum(), w[0], w[1]};
}

// A cage face with its corners, and the fourth corner of the flat quadrilateral that it is half of: the one
// across the edge between corner[1] and corner[2].
struct Patch {
  std::array<int, 3> corner = {};
  int fourth = -1;
};

// Pairs of faces that make a flat convex quadrilateral; faces that could pair with several others stay alone.
std::vector<Patch> find_patches(const TriangleMesh& cage, bool pair_up) {
  std::map<std::pair<int, int>, std::pair<int, int>>
      left;  // directed edge -> face to its left, its third corner
  for (int f = 0; f < cage.F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) left[{cage.F(f, k), cage.F(f, (k + 1) % 3)}] = {f, cage.F(f, (k + 2) % 3)};
  }
  const auto at = [&](int v) { return Eigen::Vector3d(cage.V.row(v)); };
  const auto is_flat_and_convex = [&](int i, int j, int d, int k) {
    const Eigen::Vector3d normal = (at(j) - at(i)).cross(at(k) - at(i));
    const double size = normal.norm();
    const auto part = [&](int a, int b, int c) {
      return (at(b) - at(a)).cross(at(c) - at(a)).dot(normal) / size;
    };
    return std::abs((at(d) - at(i)).dot(normal)) < 1e-12 * size * std::sqrt(size) && part(j, d, k) > 0 &&
           part(i, j, d) > 1e-6 * size && part(i, d, k) > 1e-6 * size;
  };
  std::vector<Patch> patches;
  std::vector<int> partners(static_cast<std::size_t>(cage.F.rows()), 0), partner(partners.size(), -1);
  for (int f = 0; f < cage.F.rows(); ++f) {
    patches.push_back({{cage.F(f, 0), cage.F(f, 1), cage.F(f, 2)}, -1});
    for (int k = 0; k < 3 && pair_up; ++k) {
      const int i = cage.F(f, k), j = cage.F(f, (k + 1) % 3), l = cage.F(f, (k + 2) % 3);
      const auto [other, d] = left.at({l, j});
      if (!is_flat_and_convex(i, j, d, l)) continue;
      patches.back() = {{i, j, l}, d};
      ++partners[static_cast<std::size_t>(f)];
      partner[static_cast<std::size_t>(f)] = other;
    }
  }
  for (std::size_t f = 0; f < patches.size(); ++f) {
    if (partners[f] != 1 || partners[static_cast<std::size_t>(partner[f])] != 1) patches[f].fourth = -1;
  }
  return patches;
}

// Hat functions of the cage vertices at the nodes on the cage surface (#B by #C): barycentric coordinates in
// the cage face that the node lies on.
struct BoundaryHats {
  Eigen::VectorXi nodes;
  Eigen::MatrixXd values;
};

BoundaryHats boundary_hats(const TriangleMesh& cage, const TetgenOutput& tets, bool both_diagonals) {
  Eigen::VectorXi facet = Eigen::VectorXi::Constant(tets.mesh.V.rows(), -1);
  for (Eigen::Index b = 0; b < tets.boundary.rows(); ++b) {
    if (tets.boundary_facet[b] < 0) throw Error(ErrorKind::internal, "a boundary triangle has no cage face");
    for (int k = 0; k < 3; ++k) facet[tets.boundary(b, k)] = tets.boundary_facet[b];
  }
  const std::vector<Patch> patches = find_patches(cage, both_diagonals);
  BoundaryHats hats;
  hats.nodes.resize((facet.array() >= 0).count());
  hats.values = Eigen::MatrixXd::Zero(hats.nodes.size(), cage.V.rows());
  Eigen::Index row = 0;
  for (int v = 0; v < facet.size(); ++v) {
    if (facet[v] < 0) continue;
    const Patch& patch = patches[static_cast<std::size_t>(facet[v])];
    const Eigen::Vector3d q = tets.mesh.V.row(v);
    const auto weights = [&](int a, int b, int c) {
      return barycentric(q, cage.V.row(a), cage.V.row(b), cage.V.row(c));
    };
    const auto add = [&](double share, int a, int b, int c, const Eigen::Vector3d& w) {
      hats.values(row, a) += share * w[0];
      hats.values(row, b) += share * w[1];
      hats.values(row, c) += share * w[2];
    };
    const auto [i, j, k] = patch.corner;
    const int d = patch.fourth;
    add(d < 0 ? 1 : 0.5, i, j, k, weights(i, j, k));
    if (d >= 0) {
      const Eigen::Vector3d one = weights(i, j, d), two = weights(i, d, k);
      one.minCoeff() > two.minCoeff() ? add(0.5, i, j, d, one) : add(0.5, i, d, k, two);
    }
    hats.nodes[row++] = v;
  }
  // Barycentric coordinates on an edge of the cage are -1e-17 as often as +1e-17.
  hats.values = hats.values.unaryExpr([](double value) { return std::abs(value) < 1e-14 ? 0.0 : value; });
  return hats;
}

// Solution at the points, which are the nodes from `first` on. Nodes that no tetrahedron uses (coincident
// points) and points that are no nodes are interpolated; both ways constants and positions are reproduced.
Eigen::MatrixXd at_points(const Eigen::MatrixXd& solution, const TetMesh& mesh, const Points& points,
                          Eigen::Index first, bool are_nodes) {
  std::vector<char> used(static_cast<std::size_t>(mesh.V.rows()), 0);
  for (Eigen::Index i = 0; i < mesh.T.size(); ++i) used[static_cast<std::size_t>(mesh.T.data()[i])] = 1;
  Eigen::MatrixXd weights(points.rows(), solution.cols());
  std::vector<Eigen::Index> others;
  for (Eigen::Index p = 0; p < points.rows(); ++p) {
    if (are_nodes && used[static_cast<std::size_t>(first + p)]) {
      weights.row(p) = solution.row(first + p);
    } else {
      others.push_back(p);
    }
  }
  if (others.empty()) return weights;
  weights(others, Eigen::all) = interpolate(embed(mesh, points(others, Eigen::all)), mesh.T, solution);
  return weights;
}

}  // namespace

Eigen::MatrixXd harmonic_coordinates(const TriangleMesh& cage, const Points& points,
                                     const HarmonicSettings& settings, HarmonicReport* report) {
  const double diagonal = bounding_box(cage.V).diagonal();
  check_points(cage, points, diagonal);
  const bool are_nodes = points.rows() <= settings.unknowns;
  const TetgenOutput tets = mesh_cage(cage, are_nodes ? points : Points(0, 3), diagonal, settings.unknowns);
  const BoundaryHats hats = boundary_hats(cage, tets, settings.both_diagonals);
  const LaplaceProblem laplace(tets.mesh, hats.nodes);
  Eigen::MatrixXd weights =
      at_points(laplace.solve(hats.values), tets.mesh, points, cage.V.rows(), are_nodes);

  HarmonicReport result;
  result.unknowns = laplace.unknowns();
  result.elements = tets.mesh.T.rows();
  make_exact(weights, cage.V, points, result);
  if (report) *report = result;
  return weights;
}

}  // namespace vivify::meshing
