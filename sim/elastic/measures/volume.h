// Signed volume of a tetrahedron, s = (x₁ − x₀) · ((x₂ − x₀) × (x₃ − x₀)) / 6 (m³).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace vivify::sim {

struct Volume {
  static constexpr int kPoints = 4;
  static constexpr int kSize = 12;
  static constexpr bool kMeasuresSize = true;
  using Stencil = Eigen::Matrix<double, 3, kPoints>;  // one column per point
  using Gradient = Eigen::Matrix<double, kSize, 1>;
  using Hessian = Eigen::Matrix<double, kSize, kSize>;

  static double value(const Stencil& x) {
    const Eigen::Vector3d a = x.col(1) - x.col(0), b = x.col(2) - x.col(0), c = x.col(3) - x.col(0);
    return a.dot(b.cross(c)) / 6;
  }

  static Gradient gradient(const Stencil& x) {
    const Eigen::Vector3d a = x.col(1) - x.col(0), b = x.col(2) - x.col(0), c = x.col(3) - x.col(0);
    const Eigen::Vector3d ga = b.cross(c) / 6, gb = c.cross(a) / 6, gc = a.cross(b) / 6;
    Gradient g;
    g.segment<3>(0) = -(ga + gb + gc);
    g.segment<3>(3) = ga;
    g.segment<3>(6) = gb;
    g.segment<3>(9) = gc;
    return g;
  }

  static Hessian hessian(const Stencil& x) {
    const Eigen::Vector3d a = x.col(1) - x.col(0), b = x.col(2) - x.col(0), c = x.col(3) - x.col(0);
    return from_edges(a, b, c);
  }

  // ∇³s[l]: the Hessian is linear in the points, so its derivative along l is the Hessian at l.
  static Hessian third(const Stencil&, const Gradient& l) {
    return hessian(Eigen::Map<const Stencil>(l.data()));
  }

 private:
  // Second derivatives with respect to the edge vectors, ∂²s/∂a∂b = −[c]×/6 and cyclic; point 0 takes minus
  // the sums. Every block is the cross matrix of a vector, and the blocks on the diagonal are zero.
  static Hessian from_edges(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    Hessian H = Hessian::Zero();
    const auto set = [&H](int row, int column, const Eigen::Vector3d& v) {
      const auto put = [&H, row, column](int i, int j, double value) {
        H(3 * row + i, 3 * column + j) = value;
        H(3 * column + j, 3 * row + i) = value;
      };
      put(0, 1, -v.z() / 6);
      put(0, 2, v.y() / 6);
      put(1, 0, v.z() / 6);
      put(1, 2, -v.x() / 6);
      put(2, 0, -v.y() / 6);
      put(2, 1, v.x() / 6);
    };
    set(1, 2, -c);
    set(2, 3, -a);
    set(3, 1, -b);
    set(0, 1, b - c);
    set(0, 2, c - a);
    set(0, 3, a - b);
    return H;
  }
};

}  // namespace vivify::sim
