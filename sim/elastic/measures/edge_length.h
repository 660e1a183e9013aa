// Squared edge length, s = |x₁ − x₀|² (m²): the stretch measure of rods, shells and the simplified
// tetrahedron of Coros et al. 2012, Appendix A.
#pragma once

#include "sim/elastic/measures/measure.h"

namespace vivify::sim {

template <int Dim>
struct EdgeLength : MeasureBase<Dim, 2> {
  using Base = MeasureBase<Dim, 2>;
  template <class T>
  using Stencil = typename Base::template Stencil<T>;
  template <class T>
  using Values = typename Base::template Values<T>;
  template <class T>
  using Gradients = typename Base::template Gradients<T>;
  template <class T>
  using Hessian = typename Base::template Hessian<T>;
  template <class T>
  using Direction = typename Base::template Direction<T>;
  template <class T>
  using Parameters = typename Base::template Parameters<T>;

  template <class T>
  static Values<T> values(const Stencil<T>& x, const Parameters<T>&) {
    return Values<T>((x.col(1) - x.col(0)).squaredNorm());
  }

  template <class T>
  static Gradients<T> gradients(const Stencil<T>& x, const Parameters<T>&) {
    Gradients<T> g;
    for (int axis = 0; axis < Dim; ++axis) {
      const T slope = T(2) * (x(axis, 1) - x(axis, 0));
      g[axis] = -slope;
      g[Dim + axis] = slope;
    }
    return g;
  }

  template <class T>
  static Hessian<T> hessian(const Stencil<T>&, const Parameters<T>&, const Values<T>& w) {
    Hessian<T> H = Hessian<T>::Zero();
    const T twice = T(2) * w[0];
    for (int axis = 0; axis < Dim; ++axis) {
      H(axis, axis) = H(Dim + axis, Dim + axis) = twice;
      H(axis, Dim + axis) = H(Dim + axis, axis) = -twice;
    }
    return H;
  }

  // The length squared is quadratic.
  template <class T>
  static Hessian<T> third(const Stencil<T>&, const Parameters<T>&, const Values<T>&, const Direction<T>&) {
    return Hessian<T>::Zero();
  }
};

}  // namespace vivify::sim
