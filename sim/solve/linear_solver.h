// Factorisation of a symmetric matrix whose pattern never changes: analysed once, factorised per iteration.
#pragma once

#include "sim/solve/block_cholesky.h"
#include "sim/solve/sparse_matrix.h"

namespace vivify::sim {

class LinearSolver {
 public:
  explicit LinearSolver(const SymmetricPattern& pattern) : factor_(pattern.zeros(), pattern.dimension()) {}

  // True when the matrix is positive definite; only then may solve() be called.
  bool factorize(const SymmetricMatrix& matrix) { return factor_.factorize(matrix.lower().valuePtr()); }
  // Solutions for the columns of rhs, all at once.
  Eigen::MatrixXd solve(Eigen::MatrixXd rhs) const {
    factor_.solve_in_place(rhs);
    return rhs;
  }

 private:
  BlockCholesky factor_;
};

}  // namespace vivify::sim
