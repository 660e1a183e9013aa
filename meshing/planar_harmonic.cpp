#include "meshing/planar_harmonic.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/error.h"
#include "meshing/embedding.h"
#include "meshing/enclosure.h"
#include "meshing/laplace.h"
#include "meshing/polygons.h"
#include "meshing/refine_plane.h"

namespace vivify::meshing {
namespace {

// Nearer to the cage than this part of its diagonal, a point would spoil the triangles.
constexpr double kLeastClearance = 1e-7;

// Bound on the edges, squared, times interior nodes, over the area of the cage (measured on a square, an L
// and a U).
constexpr double kSquaredEdgePerUnknown = 2.5;

// Towards a reflex vertex, where the solution behaves like a root of the distance, the boundary edges shrink
// by this factor, down to kSmallest of the cage edge.
constexpr double kGrading = 1.3;
constexpr double kSmallest = 1e-3;

// Places between 0 and 1 where the edge between two cage vertices is split.
std::vector<double> splits(bool first_is_reflex, bool second_is_reflex) {
  std::vector<double> places;
  for (double t = 0.5; t > kSmallest; t /= kGrading) {
    if (first_is_reflex) places.push_back(t);
    if (second_is_reflex) places.push_back(1 - t);
  }
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  return places;
}

PlaneTriangles mesh_cage(const Points2& cage, const Points2& points, int unknowns) {
  const int n = static_cast<int>(cage.rows());
  const Eigen::VectorXd turns = turning_angles(cage);
  std::vector<Eigen::RowVector2d> extra;
  std::vector<std::pair<int, int>> segments;
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    int last = i;
    for (const double t : splits(turns[i] < 0, turns[j] < 0)) {
      const int id = n + static_cast<int>(points.rows() + std::ssize(extra));
      extra.emplace_back((1 - t) * cage.row(i) + t * cage.row(j));
      segments.emplace_back(last, id);
      last = id;
    }
    segments.emplace_back(last, j);
  }
  Points2 all(n + points.rows() + std::ssize(extra), 2);
  all.topRows(n) = cage;
  all.middleRows(n, points.rows()) = points;
  for (std::size_t k = 0; k < extra.size(); ++k) {
    all.row(n + points.rows() + static_cast<Eigen::Index>(k)) = extra[k];
  }
  Edges edges(std::ssize(segments), 2);
  for (std::size_t s = 0; s < segments.size(); ++s) {
    edges.row(static_cast<Eigen::Index>(s)) << segments[s].first, segments[s].second;
  }
  const double longest = std::sqrt(kSquaredEdgePerUnknown * signed_area(cage) / unknowns);
  std::optional<PlaneTriangles> mesh = refine_plane(all, edges, {.longest_edge = longest});
  if (!mesh) {
    throw Error(ErrorKind::geometry, "a mesh of the cage takes too many triangles",
                "move apart what nearly touches: points, or points and the cage");
  }
  return std::move(*mesh);
}

// Hat functions of the cage vertices at the nodes on the cage (#B by #C).
struct BoundaryHats {
  Eigen::VectorXi nodes;
  Eigen::MatrixXd values;
};

BoundaryHats boundary_hats(const Points2& cage, const PlaneTriangles& mesh) {
  const std::map<int, int> next = next_on_boundary(mesh.F);
  BoundaryHats hats;
  hats.nodes.resize(std::ssize(next));
  hats.values = Eigen::MatrixXd::Zero(hats.nodes.size(), cage.rows());
  Eigen::Index row = 0;
  for (Eigen::Index i = 0; i < cage.rows(); ++i) {
    const Eigen::Index j = (i + 1) % cage.rows();
    const Eigen::RowVector2d a = cage.row(i), edge = cage.row(j) - a;
    for (int v = mesh.point[i]; v != mesh.point[j]; v = next.at(v)) {
      if (row == hats.nodes.size()) throw Error(ErrorKind::internal, "the boundary of the mesh is no loop");
      const double t = (mesh.V.row(v) - a).dot(edge) / edge.squaredNorm();
      hats.values(row, i) = 1 - t;
      hats.values(row, j) = t;
      hats.nodes[row++] = v;
    }
  }
  if (row != hats.nodes.size()) throw Error(ErrorKind::internal, "the mesh has more than one boundary");
  return hats;
}

}  // namespace

Eigen::MatrixXd harmonic_coordinates(const Points2& cage, const Points2& points,
                                     const HarmonicSettings& settings, HarmonicReport* report) {
  const std::vector<int> bad =
      points_not_inside(cage, points, kLeastClearance * box_of(cage).diagonal().norm());
  if (!bad.empty()) {
    throw Error(ErrorKind::geometry,
                std::to_string(bad.size()) + " of " + std::to_string(points.rows()) +
                    " points are not strictly inside the cage: " + list_some("points", bad),
                "enlarge the cage there");
  }
  const bool are_nodes = points.rows() <= settings.unknowns;
  const PlaneTriangles mesh = mesh_cage(cage, are_nodes ? points : Points2(0, 2), settings.unknowns);
  const BoundaryHats hats = boundary_hats(cage, mesh);
  const LaplaceProblem laplace(mesh.V, mesh.F, hats.nodes);
  const Eigen::MatrixXd solution = laplace.solve(hats.values);
  Eigen::MatrixXd weights(points.rows(), cage.rows());
  if (are_nodes) {
    for (Eigen::Index p = 0; p < points.rows(); ++p) {
      weights.row(p) = solution.row(mesh.point[cage.rows() + p]);
    }
  } else {
    weights = interpolate(embed(mesh.V, mesh.F, points), mesh.F, solution);
  }
  HarmonicReport result;
  result.unknowns = laplace.unknowns();
  result.elements = mesh.F.rows();
  make_exact(weights, cage, points, result);
  if (report) *report = result;
  return weights;
}

}  // namespace vivify::meshing
