#include "sim/solve/dense_product.h"

#include <algorithm>

#include "sim/solve/dense_tile.h"

namespace vivify::sim {
namespace {

constexpr int kTileColumns = 6;

// Entries of −Aᵀ B: rows from `row` on (packs of A), columns from `column` on, negated into `out`.
template <int kVectors, int kColumns>
void product_tile(const RowMatrixXd& A, const RowMatrixXd& B, long row, long column, Eigen::MatrixXd& out) {
  Tile<kVectors, kColumns> tile;
  tile.set_zero();
  tile.subtract_product(A.data() + row, A.cols(), B.data() + column, B.cols(), 1, static_cast<int>(A.rows()));
  tile.store([&](int j) { return &out(row, column + j); });
}

// Rows from `row` on of −Aᵀ B, in the first `columns` columns.
template <int kVectors>
void product_rows(const RowMatrixXd& A, const RowMatrixXd& B, long row, long columns, Eigen::MatrixXd& out) {
  for (long column = 0; column < columns; column += kTileColumns) {
    with_constant<kTileColumns>(static_cast<int>(std::min<long>(kTileColumns, columns - column)),
                                [&](auto width) { product_tile<kVectors, width()>(A, B, row, column, out); });
  }
}

// −Aᵀ B; with `lower` at least its lower triangle. A has at least four columns.
Eigen::MatrixXd negative_product(const RowMatrixXd& A, const RowMatrixXd& B, bool lower) {
  Eigen::MatrixXd out(A.cols(), B.cols());
  const auto columns = [&](long end) { return lower ? std::min(end, B.cols()) : B.cols(); };
  long row = 0;
  for (; row + 2 * kLanes <= A.cols(); row += 2 * kLanes) {
    product_rows<2>(A, B, row, columns(row + 2 * kLanes), out);
  }
  for (; row < A.cols(); row += kLanes) {
    product_rows<1>(A, B, std::min(row, A.cols() - kLanes), columns(row + kLanes), out);
  }
  return out;
}

}  // namespace

Eigen::MatrixXd transposed_product(const RowMatrixXd& A, const RowMatrixXd& B) {
  if (A.cols() < kLanes) return A.transpose() * B;
  return -negative_product(A, B, false);
}

Eigen::MatrixXd weighted_square(const RowMatrixXd& A, const Eigen::VectorXd& w) {
  const RowMatrixXd scaled = (-w).asDiagonal() * A;
  if (A.cols() < kLanes) return -(A.transpose() * scaled);
  return negative_product(A, scaled, true).selfadjointView<Eigen::Lower>();
}

}  // namespace vivify::sim
