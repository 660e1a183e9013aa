#include "meshing/laplace.h"

#include <Eigen/LU>
#include <algorithm>
#include <vector>

#include "common/error.h"
#include "common/parallel.h"

namespace vivify::meshing {
namespace {

// Gradients of the four hat functions of a tetrahedron, as rows.
Eigen::Matrix<double, 4, 3> hat_gradients(const TetMesh& mesh, Eigen::Index t) {
  Eigen::Matrix3d edges;  // rows
  for (int k = 1; k < 4; ++k) edges.row(k - 1) = mesh.V.row(mesh.T(t, k)) - mesh.V.row(mesh.T(t, 0));
  Eigen::Matrix<double, 4, 3> gradients;
  gradients.bottomRows<3>() = edges.inverse().transpose();
  gradients.row(0) = -gradients.bottomRows<3>().colwise().sum();
  return gradients;
}

}  // namespace

LaplaceProblem::LaplaceProblem(const TetMesh& mesh, const Eigen::VectorXi& prescribed)
    : vertices_(mesh.V.rows()), prescribed_(prescribed) {
  // Role of a vertex: an unknown (>= 0), prescribed number i (-2 - i), or unused (-1).
  constexpr int kUnused = -1;
  Eigen::VectorXi role = Eigen::VectorXi::Constant(vertices_, kUnused);
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t) {
    for (int k = 0; k < 4; ++k) role[mesh.T(t, k)] = 0;
  }
  for (int i = 0; i < prescribed_.size(); ++i) role[prescribed_[i]] = -2 - i;
  std::vector<int> unknowns;
  for (int v = 0; v < vertices_; ++v) {
    if (role[v] != 0) continue;
    role[v] = static_cast<int>(unknowns.size());
    unknowns.push_back(v);
  }
  free_ = Eigen::Map<const Eigen::VectorXi>(unknowns.data(), static_cast<Eigen::Index>(unknowns.size()));

  const Eigen::VectorXd volumes = tet_volumes(mesh);
  std::vector<Eigen::Triplet<double>> inner, coupling;
  inner.reserve(static_cast<std::size_t>(10 * mesh.T.rows()));
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t) {
    const Eigen::Matrix<double, 4, 3> g = hat_gradients(mesh, t);
    for (int i = 0; i < 4; ++i) {
      const int row = role[mesh.T(t, i)];
      if (row < 0) continue;
      for (int j = 0; j < 4; ++j) {
        const int column = role[mesh.T(t, j)];
        const double entry = volumes[t] * g.row(i).dot(g.row(j));
        if (column >= row) inner.emplace_back(column, row, entry);  // lower triangle
        if (column < kUnused) coupling.emplace_back(row, -2 - column, entry);
      }
    }
  }
  coupling_.resize(free_.size(), prescribed_.size());
  coupling_.setFromTriplets(coupling.begin(), coupling.end());
  if (free_.size() == 0) return;
  Eigen::SparseMatrix<double> stiffness(free_.size(), free_.size());
  stiffness.setFromTriplets(inner.begin(), inner.end());
  factor_.compute(stiffness);
  if (factor_.info() != Eigen::Success || !(factor_.vectorD().minCoeff() > 0)) {
    throw Error(ErrorKind::numerical, "the Laplace matrix of a tetrahedral mesh is not positive definite",
                "the mesh has flat tetrahedra or a part without prescribed values");
  }
}

Eigen::MatrixXd LaplaceProblem::solve(const Eigen::MatrixXd& values) const {
  Eigen::MatrixXd solution = Eigen::MatrixXd::Zero(vertices_, values.cols());
  for (Eigen::Index i = 0; i < prescribed_.size(); ++i) solution.row(prescribed_[i]) = values.row(i);
  if (free_.size() == 0) return solution;
  parallel_for(static_cast<std::size_t>(values.cols()), [&](std::size_t k) {
    const Eigen::Index column = static_cast<Eigen::Index>(k);
    const Eigen::VectorXd right = -(coupling_ * values.col(column));
    const Eigen::VectorXd inner = factor_.solve(right);
    for (Eigen::Index i = 0; i < free_.size(); ++i) solution(free_[i], column) = inner[i];
  });
  return solution;
}

}  // namespace vivify::meshing
