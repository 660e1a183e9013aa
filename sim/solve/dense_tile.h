// Small dense products in AVX2 registers.
#pragma once

#include <immintrin.h>

#include <type_traits>

namespace vivify::sim {

using Vector4 = __m256d;
constexpr int kLanes = 4;

// 4·kVectors rows by kColumns columns in registers: at most 12 vectors, so that the operands of a product fit
// beside them.
template <int kVectors, int kColumns>
struct Tile {
  Vector4 at[kColumns][kVectors];

  void set_zero() {
#pragma GCC unroll 16
    for (int j = 0; j < kColumns; ++j) {
#pragma GCC unroll 16
      for (int i = 0; i < kVectors; ++i) at[j][i] = _mm256_setzero_pd();
    }
  }
  // Column j from column_at(j).
  template <typename ColumnAt>
  void load(const ColumnAt& column_at) {
#pragma GCC unroll 16
    for (int j = 0; j < kColumns; ++j) {
      const double* from = column_at(j);
#pragma GCC unroll 16
      for (int i = 0; i < kVectors; ++i) at[j][i] = _mm256_loadu_pd(from + kLanes * i);
    }
  }
  template <typename ColumnAt>
  void store(const ColumnAt& column_at) const {
#pragma GCC unroll 16
    for (int j = 0; j < kColumns; ++j) {
      double* to = column_at(j);
#pragma GCC unroll 16
      for (int i = 0; i < kVectors; ++i) _mm256_storeu_pd(to + kLanes * i, at[j][i]);
    }
  }
  // Subtracts A B: A has `depth` columns `stride` apart, entry (k, j) of B is b[k·next_row + j·next_column].
  void subtract_product(const double* a, long stride, const double* b, long next_row, long next_column,
                        int depth) {
    for (int k = 0; k < depth; ++k, a += stride, b += next_row) {
      Vector4 column[kVectors];
#pragma GCC unroll 16
      for (int i = 0; i < kVectors; ++i) column[i] = _mm256_loadu_pd(a + kLanes * i);
#pragma GCC unroll 16
      for (int j = 0; j < kColumns; ++j) {
        const Vector4 factor = _mm256_broadcast_sd(b + j * next_column);
#pragma GCC unroll 16
        for (int i = 0; i < kVectors; ++i) at[j][i] = _mm256_fnmadd_pd(column[i], factor, at[j][i]);
      }
    }
  }
  // Subtracts factor times column `from` from column `to`.
  void eliminate(int to, int from, double factor) {
    const Vector4 factors = _mm256_set1_pd(factor);
#pragma GCC unroll 16
    for (int i = 0; i < kVectors; ++i) at[to][i] = _mm256_fnmadd_pd(at[from][i], factors, at[to][i]);
  }
  void scale(int column, double factor) {
    const Vector4 factors = _mm256_set1_pd(factor);
#pragma GCC unroll 16
    for (int i = 0; i < kVectors; ++i) at[column][i] = _mm256_mul_pd(at[column][i], factors);
  }
};

// All bits of the first `count` <= 4 entries, none of the others.
inline Vector4 first_lanes(int count) {
  alignas(32) static constexpr long kBits[2 * kLanes] = {-1, -1, -1, -1, 0, 0, 0, 0};
  const __m256i bits = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(kBits + kLanes - count));
  return _mm256_castsi256_pd(bits);
}

inline double sum(Vector4 v) {
  const __m128d half = _mm_add_pd(_mm256_castpd256_pd128(v), _mm256_extractf128_pd(v, 1));
  return _mm_cvtsd_f64(_mm_add_sd(half, _mm_unpackhi_pd(half, half)));
}

// call(std::integral_constant<int, n>()) for 1 <= n <= kMost.
template <int kMost, typename Call>
decltype(auto) with_constant(int n, const Call& call) {
  if constexpr (kMost > 1) {
    if (n < kMost) return with_constant<kMost - 1>(n, call);
  }
  return call(std::integral_constant<int, kMost>());
}

}  // namespace vivify::sim
