// Products with tall, narrow, row-major matrices such as ∂S/∂q, in AVX2 registers with fused multiply-add
// and every sum in a fixed order: always the same bits (docs/decisions/0002-determinism.md).
#pragma once

#include <immintrin.h>

#include <algorithm>
#include <type_traits>

#include "common/matrix.h"

namespace vivify::sim {

// kPacks packs of four numbers of a combination of rows, from `column` on; the last one ends at `columns` at
// the latest, and may hold columns that are done: they come out the same.
template <int kPacks, int kPoints, int kDim>
void combine_packs(const double* rows, const int* points, const double* weights, long weight_stride,
                   long columns, long column, double* out) {
  const long last = std::min(column + 4 * (kPacks - 1), columns - 4);
  const auto place = [&](int k) { return k + 1 < kPacks ? column + 4 * k : last; };
  __m256d sums[kPacks];
#pragma GCC unroll 16
  for (int r = 0; r < kPoints * kDim; ++r) {
    const double* row = rows + (kDim * points[r / kDim] + r % kDim) * columns;
    const __m256d weight = _mm256_broadcast_sd(weights + r * weight_stride);
#pragma GCC unroll 16
    for (int k = 0; k < kPacks; ++k) {
      const __m256d numbers = _mm256_loadu_pd(row + place(k));
      sums[k] = r == 0 ? _mm256_mul_pd(weight, numbers) : _mm256_fmadd_pd(weight, numbers, sums[k]);
    }
  }
#pragma GCC unroll 16
  for (int k = 0; k < kPacks; ++k) _mm256_storeu_pd(out + place(k), sums[k]);
}

// out = Σ weights_r · row_r over the kDim rows of each of kPoints points, in a row-major table of `columns`.
template <int kPoints, int kDim>
void combine_rows(const double* rows, const int* points, const double* weights, long weight_stride,
                  long columns, double* out) {
  if (columns < 4) {
    for (long column = 0; column < columns; ++column) {
      double sum = 0;
      for (int r = 0; r < kPoints * kDim; ++r) {
        sum += weights[r * weight_stride] * rows[(kDim * points[r / kDim] + r % kDim) * columns + column];
      }
      out[column] = sum;
    }
    return;
  }
  const auto packs = [&](auto count, long column) {
    combine_packs<count(), kPoints, kDim>(rows, points, weights, weight_stride, columns, column, out);
  };
  long column = 0;
  for (; column + 24 <= columns; column += 24) packs(std::integral_constant<int, 6>(), column);
  switch ((columns - column + 3) / 4) {
    case 1:
      return packs(std::integral_constant<int, 1>(), column);
    case 2:
      return packs(std::integral_constant<int, 2>(), column);
    case 3:
      return packs(std::integral_constant<int, 3>(), column);
    case 4:
      return packs(std::integral_constant<int, 4>(), column);
    case 5:
      return packs(std::integral_constant<int, 5>(), column);
    case 6:
      return packs(std::integral_constant<int, 6>(), column);
    default:
      return;
  }
}

// Aᵀ B for matrices with the same number of rows.
Eigen::MatrixXd transposed_product(const RowMatrixXd& A, const RowMatrixXd& B);
// Aᵀ diag(w) A.
Eigen::MatrixXd weighted_square(const RowMatrixXd& A, const Eigen::VectorXd& w);

}  // namespace vivify::sim
