// Squared edge length, s = |x₁ − x₀|² (m²): the stretch measure of rods, shells and the simplified
// tetrahedron of Coros et al. 2012, Appendix A.
#pragma once

#include <Eigen/Core>

namespace vivify::sim {

template <int Dim>
struct EdgeLength {
  static constexpr int kPoints = 2;
  static constexpr int kSize = kPoints * Dim;
  static constexpr bool kMeasuresSize = false;
  using Stencil = Eigen::Matrix<double, Dim, kPoints>;  // one column per point
  using Gradient = Eigen::Matrix<double, kSize, 1>;
  using Hessian = Eigen::Matrix<double, kSize, kSize>;

  static double value(const Stencil& x) { return (x.col(1) - x.col(0)).squaredNorm(); }

  static Gradient gradient(const Stencil& x) {
    const Eigen::Matrix<double, Dim, 1> twice_edge = 2 * (x.col(1) - x.col(0));
    Gradient g;
    g << -twice_edge, twice_edge;
    return g;
  }

  static Hessian hessian(const Stencil&) {
    const auto identity = Eigen::Matrix<double, Dim, Dim>::Identity();
    Hessian H;
    H << 2 * identity, -2 * identity, -2 * identity, 2 * identity;
    return H;
  }

  // ∇³s[l]: the length squared is quadratic.
  static Hessian third(const Stencil&, const Gradient&) { return Hessian::Zero(); }
};

}  // namespace vivify::sim
