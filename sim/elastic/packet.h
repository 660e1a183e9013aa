// Several numbers that go through the same arithmetic at once (SIMD), as a scalar type for Eigen. Lane k of a
// result depends on lane k of the operands only, and each lane gives the bits that a double would.
#pragma once

#include <immintrin.h>
#include <Eigen/Core>
#include <experimental/simd>

namespace vivify::sim {

using Packet = std::experimental::native_simd<double>;

// Number of lanes of a scalar: 1 for double.
template <class T>
inline constexpr int kLanes = 1;
template <>
inline constexpr int kLanes<Packet> = static_cast<int>(Packet::size());

// The scalar whose lane k is number(k).
template <class T, class Number>
T from_lanes(const Number& number) {
  if constexpr (kLanes<T> == 1) {
    return number(0);
  } else {
    return T([&](auto k) { return number(static_cast<int>(k)); });
  }
}

inline double lane(double value, int) { return value; }
inline double lane(const Packet& value, int k) { return value[static_cast<std::size_t>(k)]; }

// to(k)[i] += lane k of entries[i], for the first `count` lanes and kRows <= 3 entries.
template <int kRows, class To>
void add_lanes(const double* entries, int, const To& to) {
  double* place = to(0);
  for (int i = 0; i < kRows; ++i) place[i] += entries[i];
}
template <int kRows, class To>
void add_lanes(const Packet* entries, int count, const To& to) {
  static_assert(kLanes<Packet> == 4);
  __m128d pair[4], last[4];  // entries 0 and 1, and the one that is left
  if constexpr (kRows >= 2) {
    const __m256d a = static_cast<__m256d>(entries[0]), b = static_cast<__m256d>(entries[1]);
    const __m256d even = _mm256_unpacklo_pd(a, b), odd = _mm256_unpackhi_pd(a, b);
    pair[0] = _mm256_castpd256_pd128(even);
    pair[1] = _mm256_castpd256_pd128(odd);
    pair[2] = _mm256_extractf128_pd(even, 1);
    pair[3] = _mm256_extractf128_pd(odd, 1);
  }
  if constexpr (kRows % 2 == 1) {
    const __m256d a = static_cast<__m256d>(entries[kRows - 1]);
    last[0] = _mm256_castpd256_pd128(a);
    last[2] = _mm256_extractf128_pd(a, 1);
    last[1] = _mm_unpackhi_pd(last[0], last[0]);
    last[3] = _mm_unpackhi_pd(last[2], last[2]);
  }
#pragma GCC unroll 4
  for (int k = 0; k < 4; ++k) {
    if (k >= count) break;
    double* place = to(k);
    if constexpr (kRows >= 2) _mm_storeu_pd(place, _mm_add_pd(_mm_loadu_pd(place), pair[k]));
    if constexpr (kRows % 2 == 1) place[kRows - 1] += _mm_cvtsd_f64(last[k]);
  }
}

}  // namespace vivify::sim

namespace Eigen {

template <>
struct NumTraits<vivify::sim::Packet> {
  using Real = vivify::sim::Packet;
  using NonInteger = vivify::sim::Packet;
  using Literal = vivify::sim::Packet;
  using Nested = vivify::sim::Packet;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 1
  };
  static Real epsilon() { return NumTraits<double>::epsilon(); }
  static Real dummy_precision() { return NumTraits<double>::dummy_precision(); }
  static int digits10() { return NumTraits<double>::digits10(); }
};

}  // namespace Eigen
