// Factorisation of a symmetric matrix whose pattern never changes: analysed once, factorised per iteration.
#pragma once

#include <Eigen/SparseCholesky>

#include "sim/solve/sparse_matrix.h"

namespace vivify::sim {

// Eigen's simplicial LDLᵀ: the same bits for any number of threads and any BLAS
// (docs/decisions/0002-determinism.md).
class LinearSolver {
 public:
  explicit LinearSolver(const SymmetricPattern& pattern) { ldlt_.analyzePattern(pattern.zeros()); }

  // True when the matrix is positive definite; only then may solve() be called.
  bool factorize(const SymmetricMatrix& matrix) {
    ldlt_.factorize(matrix.lower());
    return ldlt_.info() == Eigen::Success && ldlt_.vectorD().minCoeff() > 0;
  }
  Eigen::MatrixXd solve(const Eigen::MatrixXd& rhs) const { return ldlt_.solve(rhs); }

 private:
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::AMDOrdering<int>> ldlt_;
};

}  // namespace vivify::sim
