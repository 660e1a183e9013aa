// Signed volume of a tetrahedron, s = (x₁ − x₀) · ((x₂ − x₀) × (x₃ − x₀)) / 6 (m³).
#pragma once

#include <Eigen/Geometry>

#include "sim/elastic/measures/measure.h"

namespace vivify::sim {

struct Volume : MeasureBase<3, 4> {
  static constexpr bool kMeasuresSize = true;

  template <class T>
  static Values<T> values(const Stencil<T>& x, const Parameters<T>&) {
    const Point<T> a = x.col(1) - x.col(0), b = x.col(2) - x.col(0), c = x.col(3) - x.col(0);
    return Values<T>(T(1.0 / 6) * a.dot(b.cross(c)));
  }

  template <class T>
  static Gradients<T> gradients(const Stencil<T>& x, const Parameters<T>&) {
    const Point<T> a = T(1.0 / 6) * (x.col(1) - x.col(0));
    const Point<T> b = x.col(2) - x.col(0), c = x.col(3) - x.col(0);
    const Point<T> ga = T(1.0 / 6) * b.cross(c), gb = c.cross(a), gc = a.cross(b);
    Gradients<T> g;
    for (int axis = 0; axis < 3; ++axis) {
      g[axis] = -(ga[axis] + gb[axis] + gc[axis]);
      g[3 + axis] = ga[axis];
      g[6 + axis] = gb[axis];
      g[9 + axis] = gc[axis];
    }
    return g;
  }

  // Second derivatives with respect to the edge vectors are ∂²s/∂a∂b = −[c]×/6 and cyclic; point 0 takes
  // minus the sums. Every block is the cross matrix of a vector, and the blocks on the diagonal are zero.
  template <class T>
  static Hessian<T> hessian(const Stencil<T>& x, const Parameters<T>&, const Values<T>& w) {
    const T scale = T(1.0 / 6) * w[0];
    const Point<T> a = scale * (x.col(1) - x.col(0)), b = scale * (x.col(2) - x.col(0)),
                   c = scale * (x.col(3) - x.col(0));
    Hessian<T> H;
    for (int i = 0; i < 4; ++i) H.template block<3, 3>(3 * i, 3 * i).setZero();
    const auto set = [&H](int row, int column, const Point<T>& v) {
      const auto put = [&H, row, column](int i, int j, const T& value) {
        H(3 * row + i, 3 * column + j) = value;
        H(3 * column + j, 3 * row + i) = value;
      };
      for (int i = 0; i < 3; ++i) put(i, i, T(0));
      put(0, 1, -v[2]);
      put(0, 2, v[1]);
      put(1, 0, v[2]);
      put(1, 2, -v[0]);
      put(2, 0, -v[1]);
      put(2, 1, v[0]);
    };
    set(2, 1, c);
    set(3, 2, a);
    set(1, 3, b);
    set(0, 1, b - c);
    set(0, 2, c - a);
    set(0, 3, a - b);
    return H;
  }

  // The Hessian is linear in the points, so its derivative along l is the Hessian at l.
  template <class T>
  static Hessian<T> third(const Stencil<T>&, const Parameters<T>& P, const Values<T>& w,
                          const Direction<T>& l) {
    return hessian<T>(Stencil<T>(l.template reshaped<Eigen::ColMajor>(3, 4)), P, w);
  }
};

}  // namespace vivify::sim
