// Signed area of a triangle in the plane, s = (x₁ − x₀) × (x₂ − x₀) / 2 (m²), positive for points in
// counter-clockwise order.
#pragma once

#include "sim/elastic/measures/measure.h"

namespace vivify::sim {

struct Area : MeasureBase<2, 3> {
  static constexpr bool kMeasuresSize = true;

  template <class T>
  static Values<T> values(const Stencil<T>& x, const Parameters<T>&) {
    const Point<T> a = x.col(1) - x.col(0), b = x.col(2) - x.col(0);
    return Values<T>(T(0.5) * (a[0] * b[1] - a[1] * b[0]));
  }

  // The slope at a point is the opposite edge, turned by a right angle, halved.
  template <class T>
  static Gradients<T> gradients(const Stencil<T>& x, const Parameters<T>&) {
    Gradients<T> g;
    for (int i = 0; i < 3; ++i) {
      const Point<T> opposite = x.col((i + 2) % 3) - x.col((i + 1) % 3);
      g[2 * i] = T(-0.5) * opposite[1];
      g[2 * i + 1] = T(0.5) * opposite[0];
    }
    return g;
  }

  // 2 s = x₀ × x₁ + x₁ × x₂ + x₂ × x₀.
  template <class T>
  static Hessian<T> hessian(const Stencil<T>&, const Parameters<T>&, const Values<T>& w) {
    Hessian<T> H = Hessian<T>::Zero();
    const T half = T(0.5) * w[0];
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      H(2 * i, 2 * j + 1) = H(2 * j + 1, 2 * i) = half;
      H(2 * i + 1, 2 * j) = H(2 * j, 2 * i + 1) = -half;
    }
    return H;
  }

  // The area is quadratic.
  template <class T>
  static Hessian<T> third(const Stencil<T>&, const Parameters<T>&, const Values<T>&, const Direction<T>&) {
    return Hessian<T>::Zero();
  }
};

}  // namespace vivify::sim
