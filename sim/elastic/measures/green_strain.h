// Green strain of a triangle in the plane or a tetrahedron, in the metric of a fixed reference element:
//   E = ½ (Fᵀ F − 1),  F = D(x) D̄⁻¹,  D = [x₁ − x₀, x₂ − x₀, …].
// The components are E₁₁, E₂₂, √2 E₁₂, or E₁₁, E₂₂, E₃₃, √2 E₂₃, √2 E₁₃, √2 E₁₂, so that Σ s² = ‖E‖².
// The parameters are the entries of D̄⁻¹ (1/m), column by column.
#pragma once

#include <numbers>

#include "sim/elastic/measures/measure.h"

namespace vivify::sim {

template <int Dim>
struct GreenStrain : MeasureBase<Dim, Dim + 1, Dim*(Dim + 1) / 2, Dim * Dim> {
  using Base = MeasureBase<Dim, Dim + 1, Dim*(Dim + 1) / 2, Dim * Dim>;
  template <class T>
  using Block = typename Base::template Block<T>;
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

  // s_ab = (f_a · f_b − δ_ab) / 2 with the columns f of F.
  template <class T>
  static Values<T> values(const Stencil<T>& x, const Parameters<T>& P) {
    const Block<T> F = deformation<T>(x, P);
    Values<T> s;
    for (int a = 0; a < Dim; ++a) s[a] = T(0.5) * (F.col(a).squaredNorm() - T(1));
    for (int k = Dim; k < Base::kComponents; ++k) s[k] = T(kShear) * F.col(first(k)).dot(F.col(second(k)));
    return s;
  }

  // ∂f_a/∂x_i = N_ia 1.
  template <class T>
  static Gradients<T> gradients(const Stencil<T>& x, const Parameters<T>& P) {
    const Block<T> F = deformation<T>(x, P);
    const Shape<T> N = shape<T>(P);
    Gradients<T> g;
    for (int i = 0; i < Base::kPoints; ++i) {
      for (int axis = 0; axis < Dim; ++axis) {
        const int row = Dim * i + axis;
        for (int a = 0; a < Dim; ++a) g(row, a) = N(i, a) * F(axis, a);
        for (int k = Dim; k < Base::kComponents; ++k) {
          const int a = first(k), b = second(k);
          g(row, k) = T(kShear) * (N(i, a) * F(axis, b) + N(i, b) * F(axis, a));
        }
      }
    }
    return g;
  }

  // Between points i and j: (N W Nᵀ)_ij 1 with the symmetric matrix W of the weights.
  template <class T>
  static Hessian<T> hessian(const Stencil<T>&, const Parameters<T>& P, const Values<T>& w) {
    const Shape<T> N = shape<T>(P);
    Block<T> W;
    for (int a = 0; a < Dim; ++a) W(a, a) = w[a];
    for (int k = Dim; k < Base::kComponents; ++k) {
      W(first(k), second(k)) = W(second(k), first(k)) = T(kShear) * w[k];
    }
    Hessian<T> H;
    for (int i = 0; i < Base::kPoints; ++i) {
      const Eigen::Matrix<T, Dim, 1> row = W * N.row(i).transpose();
      for (int j = 0; j <= i; ++j) {
        const T entry = row.dot(N.row(j));
        for (int a = 0; a < Dim; ++a) {
          for (int b = 0; b < Dim; ++b) {
            H(Dim * i + a, Dim * j + b) = H(Dim * j + b, Dim * i + a) = a == b ? entry : T(0);
          }
        }
      }
    }
    return H;
  }

  // The strain is quadratic.
  template <class T>
  static Hessian<T> third(const Stencil<T>&, const Parameters<T>&, const Values<T>&, const Direction<T>&) {
    return Hessian<T>::Zero();
  }

 private:
  static constexpr double kShear = std::numbers::sqrt2 / 2;
  // The axes of shear component k.
  static constexpr int first(int k) { return k == 5 || Dim == 2 ? 0 : 4 - k; }
  static constexpr int second(int k) { return k == 5 || Dim == 2 ? 1 : 2; }

  // Slopes of the shape functions: f_a = Σ N_ia x_i.
  template <class T>
  using Shape = Eigen::Matrix<T, Base::kPoints, Dim>;
  template <class T>
  static Shape<T> shape(const Parameters<T>& P) {
    Shape<T> N;
    for (int a = 0; a < Dim; ++a) {
      T sum = P[Dim * a];
      N(1, a) = P[Dim * a];
      for (int k = 1; k < Dim; ++k) {
        N(k + 1, a) = P[Dim * a + k];
        sum += P[Dim * a + k];
      }
      N(0, a) = -sum;
    }
    return N;
  }

  // From differences of the points, which keeps digits far from the origin.
  template <class T>
  static Block<T> deformation(const Stencil<T>& x, const Parameters<T>& P) {
    Block<T> F;
    for (int axis = 0; axis < Dim; ++axis) {
      for (int a = 0; a < Dim; ++a) {
        T sum = (x(axis, 1) - x(axis, 0)) * P[Dim * a];
        for (int k = 1; k < Dim; ++k) sum += (x(axis, k + 1) - x(axis, 0)) * P[Dim * a + k];
        F(axis, a) = sum;
      }
    }
    return F;
  }
};

}  // namespace vivify::sim
