#include "meshing/laplace.h"

#include <Eigen/LU>
#include <algorithm>
#include <vector>

#include "common/error.h"
#include "common/parallel.h"

namespace vivify::meshing {
namespace {

template <int kDim>
using Vertices = Eigen::Matrix<double, Eigen::Dynamic, kDim, Eigen::RowMajor>;
template <int kDim>
using Elements = Eigen::Matrix<int, Eigen::Dynamic, kDim + 1, Eigen::RowMajor>;

// Gradients of the hat functions of a simplex, as rows.
template <int kDim>
Eigen::Matrix<double, kDim + 1, kDim> hat_gradients(const Vertices<kDim>& V, const Elements<kDim>& E,
                                                    Eigen::Index t) {
  Eigen::Matrix<double, kDim, kDim> edges;  // rows
  for (int k = 1; k <= kDim; ++k) edges.row(k - 1) = V.row(E(t, k)) - V.row(E(t, 0));
  Eigen::Matrix<double, kDim + 1, kDim> gradients;
  gradients.template bottomRows<kDim>() = edges.inverse().transpose();
  gradients.row(0) = -gradients.template bottomRows<kDim>().colwise().sum();
  return gradients;
}

}  // namespace

LaplaceProblem::LaplaceProblem(const TetMesh& mesh, const Eigen::VectorXi& prescribed)
    : vertices_(mesh.V.rows()), prescribed_(prescribed) {
  assemble<3>(mesh.V, mesh.T, tet_volumes(mesh));
}

LaplaceProblem::LaplaceProblem(const Points2& V, const Triangles& F, const Eigen::VectorXi& prescribed)
    : vertices_(V.rows()), prescribed_(prescribed) {
  assemble<2>(V, F, element_sizes({V, F}));
}

template <int kDim>
void LaplaceProblem::assemble(const Vertices<kDim>& V, const Elements<kDim>& E,
                              const Eigen::VectorXd& sizes) {
  // Role of a vertex: an unknown (>= 0), prescribed number i (-2 - i), or unused (-1).
  constexpr int kUnused = -1;
  Eigen::VectorXi role = Eigen::VectorXi::Constant(vertices_, kUnused);
  for (Eigen::Index t = 0; t < E.rows(); ++t) {
    for (int k = 0; k <= kDim; ++k) role[E(t, k)] = 0;
  }
  for (int i = 0; i < prescribed_.size(); ++i) role[prescribed_[i]] = -2 - i;
  std::vector<int> unknowns;
  for (int v = 0; v < vertices_; ++v) {
    if (role[v] != 0) continue;
    role[v] = static_cast<int>(unknowns.size());
    unknowns.push_back(v);
  }
  free_ = Eigen::Map<const Eigen::VectorXi>(unknowns.data(), static_cast<Eigen::Index>(unknowns.size()));

  std::vector<Eigen::Triplet<double>> inner, coupling;
  inner.reserve(static_cast<std::size_t>(10 * E.rows()));
  for (Eigen::Index t = 0; t < E.rows(); ++t) {
    const Eigen::Matrix<double, kDim + 1, kDim> g = hat_gradients<kDim>(V, E, t);
    for (int i = 0; i <= kDim; ++i) {
      const int row = role[E(t, i)];
      if (row < 0) continue;
      for (int j = 0; j <= kDim; ++j) {
        const int column = role[E(t, j)];
        const double entry = sizes[t] * g.row(i).dot(g.row(j));
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
    throw Error(ErrorKind::numerical, "the Laplace matrix of a mesh is not positive definite",
                "the mesh has flat elements or a part without prescribed values");
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
