// Squared area of a triangle in space, s = |a × b|² / 4 with the edges a = x₁ − x₀ and b = x₂ − x₀ (m⁴).
// Unlike the area itself it has no square root, and its fifth derivatives vanish.
#pragma once

#include <Eigen/Geometry>

#include "sim/elastic/dual.h"
#include "sim/elastic/family_of.h"
#include "sim/elastic/measures/measure.h"

namespace vivify::sim {

struct SquaredArea : MeasureBase<3, 3> {
  static constexpr bool kMeasuresSize = true;  // its ratio to that at rest tells collapse

  template <class T>
  static Values<T> values(const Stencil<T>& x, const Parameters<T>&) {
    const Point<T> a = x.col(1) - x.col(0), b = x.col(2) - x.col(0);
    return Values<T>(T(0.25) * a.cross(b).squaredNorm());
  }

  // ∂s/∂a = b × n / 2 and ∂s/∂b = n × a / 2 with n = a × b.
  template <class T>
  static Gradients<T> gradients(const Stencil<T>& x, const Parameters<T>&) {
    const Point<T> a = x.col(1) - x.col(0), b = x.col(2) - x.col(0), n = a.cross(b);
    Gradients<T> g;
    g.template segment<3>(3) = T(0.5) * b.cross(n);
    g.template segment<3>(6) = T(0.5) * n.cross(a);
    g.template segment<3>(0) = -(g.template segment<3>(3) + g.template segment<3>(6));
    return g;
  }

  // From s = (|a|² |b|² − (a·b)²) / 4; the rows and columns of x₀ are minus the sums of the others.
  template <class T>
  static Hessian<T> hessian(const Stencil<T>& x, const Parameters<T>&, const Values<T>& w) {
    const Point<T> a = x.col(1) - x.col(0), b = x.col(2) - x.col(0);
    const T half = T(0.5) * w[0], aa = a.squaredNorm(), bb = b.squaredNorm(), ab = a.dot(b);
    Hessian<T> H;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const T unit(i == j ? 1.0 : 0.0);
        H(3 + i, 3 + j) = half * (bb * unit - b[i] * b[j]);
        H(6 + i, 6 + j) = half * (aa * unit - a[i] * a[j]);
        H(3 + i, 6 + j) = H(6 + j, 3 + i) = half * (T(2.0) * a[i] * b[j] - b[i] * a[j] - ab * unit);
      }
    }
    for (int r = 3; r < 9; ++r) {
      for (int j = 0; j < 3; ++j) H(r, j) = H(j, r) = -(H(r, 3 + j) + H(r, 6 + j));
    }
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) H(i, j) = -(H(3 + i, j) + H(6 + i, j));
    }
    return H;
  }

  // The Hessian along l, with numbers that carry their slope.
  template <class T>
  static Hessian<T> third(const Stencil<T>& x, const Parameters<T>&, const Values<T>& w,
                          const Direction<T>& l) {
    Stencil<Dual<T>> moving;
    for (int i = 0; i < kSize; ++i) moving(i % 3, i / 3) = Dual<T>(x(i % 3, i / 3), l[i]);
    const Hessian<Dual<T>> H = hessian<Dual<T>>(moving, {}, Values<Dual<T>>(Dual<T>(w[0])));
    Hessian<T> slope;
    for (int j = 0; j < kSize; ++j) {
      for (int i = 0; i < kSize; ++i) slope(i, j) = H(i, j).slope;
    }
    return slope;
  }
};

inline std::unique_ptr<MeasureFamily> make_squared_area(Kernels kernels) {
  return quadratic_family<SquaredArea>("squared_area", kernels);
}

inline constexpr MeasureEntry kSquaredArea = {"squared_area", 3, make_squared_area};

}  // namespace vivify::sim
