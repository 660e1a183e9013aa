// Dihedral angle of a hinge: edge x₀ x₁, wings (x₀, x₁, x₂) and (x₁, x₀, x₃), with normals
// n₂ = e × (x₂ − x₀) and n₃ = (x₃ − x₀) × e, e = x₁ − x₀:
//   s = atan2((n₂ × n₃) · e / |e|, n₂ · n₃)   (rad).
// Zero for a flat hinge, positive when it is a ridge seen from the side of the normals. The derivatives have
// no trigonometry: with L = |e|, the height h_k of wing k and t_k = (x_k − x₀) · e / L², where its foot lies,
//   g₂ = −n₂ / (L h₂²),  g₃ = −n₃ / (L h₃²),
//   g₀ = −(1 − t₂) g₂ − (1 − t₃) g₃,  g₁ = −t₂ g₂ − t₃ g₃
// are the slopes at the four points.
#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "sim/elastic/dual.h"
#include "sim/elastic/measures/measure.h"

namespace vivify::sim {

struct DihedralAngle : MeasureBase<3, 4> {
  static constexpr bool kPeriodic = true;

  // (n₂ × n₃) · e = −|e|² n₂ · (x₃ − x₀).
  template <class T>
  static Values<T> values(const Stencil<T>& x, const Parameters<T>&) {
    using std::atan2;
    using std::sqrt;
    const Point<T> e = x.col(1) - x.col(0), b = x.col(3) - x.col(0);
    const Point<T> n2 = e.cross(x.col(2) - x.col(0)), n3 = b.cross(e);
    return Values<T>(atan2(-sqrt(e.squaredNorm()) * n2.dot(b), n2.dot(n3)));
  }

  template <class T>
  static Gradients<T> gradients(const Stencil<T>& x, const Parameters<T>&) {
    const Hinge<T> hinge(x);
    const Point<T>& g2 = hinge.wings[0].slope;
    const Point<T>& g3 = hinge.wings[1].slope;
    Gradients<T> g;
    for (int axis = 0; axis < 3; ++axis) {
      const T g1 = -(hinge.wings[0].foot * g2[axis] + hinge.wings[1].foot * g3[axis]);
      g[axis] = -(g1 + g2[axis] + g3[axis]);
      g[3 + axis] = g1;
      g[6 + axis] = g2[axis];
      g[9 + axis] = g3[axis];
    }
    return g;
  }

  // The product rule, simplified. Each wing k gives, with its own curvature
  //   S = ∂g_k/∂x_k = −(g_k c_kᵀ + c_k g_kᵀ),  c₂ = e × g₂ / L,  c₃ = −e × g₃ / L
  // and R = g_k eᵀ / L², the blocks
  //   kk: S,  k1: −t S − Rᵀ,  k0: −(1 − t) S + Rᵀ,
  //   11: (t² + q) S + t (R + Rᵀ),  10: (t (1 − t) − q) S + (1 − t) R − t Rᵀ,
  //   00: ((1 − t)² + q) S − (1 − t) (R + Rᵀ),   q = h_k² / (2 L²).
  template <class T>
  static Hessian<T> hessian(const Stencil<T>& x, const Parameters<T>&, const Values<T>& w) {
    const Hinge<T> hinge(x);
    Hessian<T> H;
    H.template block<3, 3>(6, 9).setZero();
    H.template block<3, 3>(9, 6).setZero();
    Block<T> H00 = Block<T>::Zero(), H10 = Block<T>::Zero(), H11 = Block<T>::Zero();
    for (int side = 0; side < 2; ++side) {
      const Wing<T>& wing = hinge.wings[side];
      const int k = 6 + 3 * side;
      const T t = wing.foot, rest = T(1) - t, q = T(0.5) * wing.height_squared * hinge.inverse_squared;
      const Point<T> g = w[0] * wing.slope, c = wing.across, e = hinge.inverse_squared * hinge.e;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          const T S = -(g[i] * c[j] + c[i] * g[j]), R = g[i] * e[j], Rt = e[i] * g[j];
          H(k + i, k + j) = S;
          H(k + i, 3 + j) = H(3 + j, k + i) = -t * S - Rt;
          H(k + i, j) = H(j, k + i) = Rt - rest * S;
          H11(i, j) += (t * t + q) * S + t * (R + Rt);
          H10(i, j) += (t * rest - q) * S + rest * R - t * Rt;
          H00(i, j) += (rest * rest + q) * S - rest * (R + Rt);
        }
      }
    }
    H.template block<3, 3>(0, 0) = H00;
    H.template block<3, 3>(3, 0) = H10;
    H.template block<3, 3>(0, 3) = H10.transpose();
    H.template block<3, 3>(3, 3) = H11;
    return H;
  }

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

 private:
  template <class T>
  struct Wing {
    Point<T> slope, across;  // g, c
    T foot, height_squared;  // t, h²
  };

  template <class T>
  struct Hinge {
    Point<T> e;
    T inverse_squared;  // 1 / L²
    Wing<T> wings[2];

    explicit Hinge(const Stencil<T>& x) : e(x.col(1) - x.col(0)) {
      using std::sqrt;
      const T squared = e.squaredNorm();
      inverse_squared = T(1) / squared;
      const T length = sqrt(squared), inverse = length * inverse_squared;
      for (int side = 0; side < 2; ++side) {
        const T sign = T(side == 0 ? 1 : -1);
        const Point<T> spoke = x.col(2 + side) - x.col(0), n = e.cross(spoke);
        const T doubled_area_squared = n.squaredNorm();
        Wing<T>& wing = wings[side];
        wing.slope = (-sign * length / doubled_area_squared) * n;
        wing.across = (sign * inverse) * e.cross(wing.slope);
        wing.foot = spoke.dot(e) * inverse_squared;
        wing.height_squared = doubled_area_squared * inverse_squared;
      }
    }
  };
};

}  // namespace vivify::sim
