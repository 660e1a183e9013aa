#include "meshing/harmonic.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <string>
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

// Hat functions of the cage vertices at the nodes on the cage surface (#B by #C): barycentric coordinates in
// the cage face that the node lies on.
struct BoundaryHats {
  Eigen::VectorXi nodes;
  Eigen::MatrixXd values;
};

BoundaryHats boundary_hats(const TriangleMesh& cage, const TetgenOutput& tets) {
  Eigen::VectorXi facet = Eigen::VectorXi::Constant(tets.mesh.V.rows(), -1);
  for (Eigen::Index b = 0; b < tets.boundary.rows(); ++b) {
    if (tets.boundary_facet[b] < 0) throw Error(ErrorKind::internal, "a boundary triangle has no cage face");
    for (int k = 0; k < 3; ++k) facet[tets.boundary(b, k)] = tets.boundary_facet[b];
  }
  BoundaryHats hats;
  hats.nodes.resize((facet.array() >= 0).count());
  hats.values = Eigen::MatrixXd::Zero(hats.nodes.size(), cage.V.rows());
  Eigen::Index row = 0;
  for (int v = 0; v < facet.size(); ++v) {
    if (facet[v] < 0) continue;
    const auto face = cage.F.row(facet[v]);
    const Eigen::Vector3d origin = cage.V.row(face[0]);
    Eigen::Matrix<double, 3, 2> edges;
    edges << cage.V.row(face[1]).transpose() - origin, cage.V.row(face[2]).transpose() - origin;
    const Eigen::Vector2d b = edges.colPivHouseholderQr().solve(tets.mesh.V.row(v).transpose() - origin);
    hats.nodes[row] = v;
    hats.values(row, face[0]) = 1 - b.sum();
    hats.values(row, face[1]) = b[0];
    hats.values(row, face[2]) = b[1];
    ++row;
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
  const Embedding embedding = embed(mesh, points(others, Eigen::all));
  for (std::size_t i = 0; i < others.size(); ++i) {
    weights.row(others[i]).setZero();
    const Eigen::Index row = static_cast<Eigen::Index>(i);
    for (int k = 0; k < 4; ++k) {
      weights.row(others[i]) += embedding.weights(row, k) * solution.row(mesh.T(embedding.tet[row], k));
    }
  }
  return weights;
}

}  // namespace

Eigen::VectorXd project_weights(const Eigen::VectorXd& weights, const Points& C, const Eigen::Vector3d& x) {
  // The minimiser is w = max(0, w0 + A^T y) with A w = b; the multipliers y maximise a concave, piecewise
  // quadratic function of four variables, which a damped Newton method does in finitely many steps.
  const double size = bounding_box(C).diagonal();
  Eigen::Matrix<double, 4, Eigen::Dynamic> A(4, C.rows());
  A.row(0).setOnes();
  A.bottomRows<3>() = (C.transpose().colwise() - x) / size;
  const Eigen::Vector4d b(1, 0, 0, 0);
  const auto primal = [&](const Eigen::Vector4d& y) {
    return (weights + A.transpose() * y).cwiseMax(0).eval();
  };
  const auto dual = [&](const Eigen::Vector4d& y) { return y.dot(b) - 0.5 * primal(y).squaredNorm(); };

  Eigen::Vector4d y = Eigen::Vector4d::Zero();
  Eigen::VectorXd w = primal(y);
  for (int iteration = 0; iteration < 200; ++iteration) {
    const Eigen::Vector4d residual = b - A * w;
    if (residual.norm() < 1e-15) break;
    Eigen::Matrix4d H = Eigen::Matrix4d::Zero();
    for (Eigen::Index c = 0; c < C.rows(); ++c) {
      if (w[c] > 0) H += A.col(c) * A.col(c).transpose();
    }
    H.diagonal().array() += 1e-14 * std::max(1.0, H.trace());  // free columns may not span all four rows
    const Eigen::Vector4d step = H.ldlt().solve(residual);
    double length = 1;
    const double start = dual(y), slope = residual.dot(step);
    while (length > 1e-10 && dual(y + length * step) < start + 1e-4 * length * slope - 1e-16) length /= 2;
    y += length * step;
    w = primal(y);
  }
  // A last correction within the free columns takes out round-off.
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<Eigen::Index> free;
    for (Eigen::Index c = 0; c < C.rows(); ++c) {
      if (w[c] > 0) free.push_back(c);
    }
    const Eigen::MatrixXd columns = A(Eigen::all, free);
    const Eigen::VectorXd change = columns.completeOrthogonalDecomposition().solve(b - A * w);
    for (std::size_t i = 0; i < free.size(); ++i) {
      w[free[i]] = std::max(0.0, w[free[i]] + change[static_cast<Eigen::Index>(i)]);
    }
  }
  if (!((b - A * w).norm() < 1e-11)) {
    throw Error(ErrorKind::numerical, "a point has no weights >= 0 in its cage",
                "it lies outside the convex hull of the cage");
  }
  return w.cwiseMin(1);
}

Eigen::MatrixXd harmonic_coordinates(const TriangleMesh& cage, const Points& points,
                                     const HarmonicSettings& settings, HarmonicReport* report) {
  const double diagonal = bounding_box(cage.V).diagonal();
  check_points(cage, points, diagonal);
  const bool are_nodes = points.rows() <= settings.unknowns;
  const TetgenOutput tets = mesh_cage(cage, are_nodes ? points : Points(0, 3), diagonal, settings.unknowns);
  const BoundaryHats hats = boundary_hats(cage, tets);
  const LaplaceProblem laplace(tets.mesh, hats.nodes);
  Eigen::MatrixXd weights =
      at_points(laplace.solve(hats.values), tets.mesh, points, cage.V.rows(), are_nodes);

  HarmonicReport result;
  result.unknowns = laplace.unknowns();
  result.tetrahedra = tets.mesh.T.rows();
  result.most_negative = points.rows() == 0 ? 0 : std::min(0.0, weights.minCoeff());
  for (Eigen::Index p = 0; p < points.rows(); ++p) {
    if (weights.row(p).minCoeff() < 0 || weights.row(p).maxCoeff() > 1) {
      weights.row(p) = project_weights(weights.row(p), cage.V, points.row(p));
      ++result.projected;
    }
    result.sum_error = std::max(result.sum_error, std::abs(weights.row(p).sum() - 1));
    result.position_error =
        std::max(result.position_error, (weights.row(p) * cage.V - points.row(p)).norm() / diagonal);
  }
  if (result.sum_error > 1e-10 || result.position_error > 1e-10) {
    throw Error(ErrorKind::numerical,
                "the harmonic coordinates do not reproduce the points: error " +
                    number_text(std::max(result.sum_error, result.position_error)),
                "the cage has faces or features that are too thin");
  }
  if (report) *report = result;
  return weights;
}

}  // namespace vivify::meshing
