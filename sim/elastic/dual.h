// Dual number: a value and its derivative along one direction (forward automatic differentiation).
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <concepts>

namespace vivify::sim {

// T is double or a pack of doubles. As with those, a number made without a value holds anything.
template <class T>
struct Dual {
  T value, slope;

  Dual() = default;
  template <std::convertible_to<T> Constant>
  Dual(const Constant& constant) : value(constant), slope(T(0.0)) {}
  Dual(const T& v, const T& s) : value(v), slope(s) {}

  friend Dual operator-(const Dual& a) { return {-a.value, -a.slope}; }
  friend Dual operator+(const Dual& a, const Dual& b) { return {a.value + b.value, a.slope + b.slope}; }
  friend Dual operator-(const Dual& a, const Dual& b) { return {a.value - b.value, a.slope - b.slope}; }
  friend Dual operator*(const Dual& a, const Dual& b) {
    return {a.value * b.value, a.slope * b.value + a.value * b.slope};
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    const T quotient = a.value / b.value;
    return {quotient, (a.slope - quotient * b.slope) / b.value};
  }
  Dual& operator+=(const Dual& b) { return *this = *this + b; }

  friend Dual sqrt(const Dual& a) {
    using std::sqrt;
    const T root = sqrt(a.value);
    return {root, T(0.5) * a.slope / root};
  }
};

}  // namespace vivify::sim

namespace Eigen {

template <class T>
struct NumTraits<vivify::sim::Dual<T>> : GenericNumTraits<double> {
  using Real = vivify::sim::Dual<T>;
  using NonInteger = Real;
  using Nested = Real;
  enum { RequireInitialization = 0, ReadCost = 2, AddCost = 2, MulCost = 4 };
};

}  // namespace Eigen
