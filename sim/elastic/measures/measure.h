// What every measure is: static functions of a stencil of points, templated on the scalar T, which is double
// or a pack of doubles. They therefore never branch on a value.
//   values(x, P)          s, one value per component
//   gradients(x, P)       ∇s, one column per component, coordinates point by point
//   hessian(x, P, w)      Σ w_k ∇²s_k
//   third(x, P, w, l)     Σ w_k ∇³s_k[l], the derivative of that Hessian along l
// P are constants of the term, taken from its reference shape.
#pragma once

#include <Eigen/Core>

namespace vivify::sim {

template <int Dim, int Points, int Components = 1, int ParameterCount = 0>
struct MeasureBase {
  static constexpr int kDim = Dim;
  static constexpr int kPoints = Points;
  static constexpr int kComponents = Components;
  static constexpr int kParameters = ParameterCount;
  static constexpr int kSize = kDim * kPoints;
  // Whether s is the signed size of an element (area, volume): its ratio to the reference tells collapse and
  // inversion.
  static constexpr bool kMeasuresSize = false;
  // Whether s is an angle: differences are meant modulo 2π.
  static constexpr bool kPeriodic = false;

  template <class T>
  using Point = Eigen::Matrix<T, kDim, 1>;
  template <class T>
  using Block = Eigen::Matrix<T, kDim, kDim>;  // the part of a Hessian between two points
  template <class T>
  using Stencil = Eigen::Matrix<T, kDim, kPoints>;  // one column per point
  template <class T>
  using Values = Eigen::Matrix<T, kComponents, 1>;
  template <class T>
  using Gradients = Eigen::Matrix<T, kSize, kComponents>;
  template <class T>
  using Hessian = Eigen::Matrix<T, kSize, kSize>;
  template <class T>
  using Direction = Eigen::Matrix<T, kSize, 1>;
  template <class T>
  using Parameters = Eigen::Matrix<T, kParameters, 1>;
};

}  // namespace vivify::sim
