// Turning angle at the middle of three points in the plane, s = atan2(a × b, a · b) with a = x₁ − x₀ and
// b = x₂ − x₁ (rad): zero on a straight line, positive for a left turn. It is φ(b) − φ(a) with the polar
// angle φ = Im log(e_x + i e_y), whose derivatives are those of the complex logarithm.
#pragma once

#include <cmath>

#include "sim/elastic/measures/measure.h"

namespace vivify::sim {

struct TurningAngle : MeasureBase<2, 3> {
  static constexpr bool kPeriodic = true;

  template <class T>
  static Values<T> values(const Stencil<T>& x, const Parameters<T>&) {
    using std::atan2;
    const Point<T> a = x.col(1) - x.col(0), b = x.col(2) - x.col(1);
    return Values<T>(atan2(a[0] * b[1] - a[1] * b[0], a.dot(b)));
  }

  template <class T>
  static Gradients<T> gradients(const Stencil<T>& x, const Parameters<T>&) {
    const Point<T> ga = slope<T>(x.col(1) - x.col(0)), gb = slope<T>(x.col(2) - x.col(1));
    Gradients<T> g;
    g.template segment<2>(0) = ga;
    g.template segment<2>(2) = -ga - gb;
    g.template segment<2>(4) = gb;
    return g;
  }

  // φ(z)'' = −1/z².
  template <class T>
  static Hessian<T> hessian(const Stencil<T>& x, const Parameters<T>&, const Values<T>& w) {
    const auto curvature = [&w](const Point<T>& e) -> Point<T> {
      const Point<T> inverse = reciprocal<T>(e);
      return -w[0] * product<T>(inverse, inverse);
    };
    return assemble<T>(curvature(x.col(1) - x.col(0)), curvature(x.col(2) - x.col(1)));
  }

  // φ(z)''' = 2/z³.
  template <class T>
  static Hessian<T> third(const Stencil<T>& x, const Parameters<T>&, const Values<T>& w,
                          const Direction<T>& l) {
    const auto change = [&w](const Point<T>& e, const Point<T>& along) -> Point<T> {
      const Point<T> inverse = reciprocal<T>(e);
      return T(2) * w[0] * product<T>(product<T>(inverse, inverse), product<T>(inverse, along));
    };
    return assemble<T>(change(x.col(1) - x.col(0), l.template segment<2>(2) - l.template segment<2>(0)),
                       change(x.col(2) - x.col(1), l.template segment<2>(4) - l.template segment<2>(2)));
  }

 private:
  // Complex numbers as points of the plane.
  template <class T>
  static Point<T> product(const Point<T>& z, const Point<T>& w) {
    return Point<T>(z[0] * w[0] - z[1] * w[1], z[0] * w[1] + z[1] * w[0]);
  }
  template <class T>
  static Point<T> reciprocal(const Point<T>& z) {
    const T scale = T(1) / z.squaredNorm();
    return Point<T>(scale * z[0], -scale * z[1]);
  }
  template <class T>
  static Point<T> slope(const Point<T>& e) {
    const T scale = T(1) / e.squaredNorm();
    return Point<T>(-scale * e[1], scale * e[0]);
  }

  // The second derivative of φ is [Im u, Re u; Re u, −Im u] for the complex second derivative u of the
  // logarithm; ua and ub are those of the two edges.
  template <class T>
  static Hessian<T> assemble(const Point<T>& ua, const Point<T>& ub) {
    Hessian<T> H;
    const auto set = [&H](int i, int j, const Point<T>& u) {
      H(2 * i, 2 * j) = u[1];
      H(2 * i, 2 * j + 1) = H(2 * i + 1, 2 * j) = u[0];
      H(2 * i + 1, 2 * j + 1) = -u[1];
    };
    set(0, 0, -ua);
    set(0, 1, ua);
    set(1, 0, ua);
    set(1, 1, ub - ua);
    set(1, 2, -ub);
    set(2, 1, -ub);
    set(2, 2, ub);
    set(0, 2, Point<T>::Zero());
    set(2, 0, Point<T>::Zero());
    return H;
  }
};

}  // namespace vivify::sim
