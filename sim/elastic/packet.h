// Several numbers that go through the same arithmetic at once (SIMD), as a scalar type for Eigen. Lane k of a
// result depends on lane k of the operands only, and each lane gives the bits that a double would.
#pragma once

#include <Eigen/Core>
#include <experimental/simd>

namespace vivify::sim {

using Packet = std::experimental::native_simd<double>;

// Number of lanes of a scalar: 1 for double.
template <class T>
inline constexpr int kLanes = 1;
template <>
inline constexpr int kLanes<Packet> = static_cast<int>(Packet::size());

inline double lane(double value, int) { return value; }
inline double lane(const Packet& value, int k) { return value[static_cast<std::size_t>(k)]; }
inline void set_lane(double& value, int, double v) { value = v; }
inline void set_lane(Packet& value, int k, double v) { value[static_cast<std::size_t>(k)] = v; }

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
