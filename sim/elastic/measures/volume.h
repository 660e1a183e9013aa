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
    g << -(ga + gb + gc), ga, gb, gc;
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
  static Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
    Eigen::Matrix3d m;
    m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return m;
  }

  // Second derivatives with respect to the edge vectors, ∂²s/∂a∂b = −[c]×/6 and cyclic; point 0 takes minus
  // the sums.
  static Hessian from_edges(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    const Eigen::Matrix3d ab = -cross_matrix(c) / 6, bc = -cross_matrix(a) / 6, ca = -cross_matrix(b) / 6;
    Hessian H = Hessian::Zero();
    H.block<3, 3>(3, 6) = ab;
    H.block<3, 3>(6, 3) = ab.transpose();
    H.block<3, 3>(6, 9) = bc;
    H.block<3, 3>(9, 6) = bc.transpose();
    H.block<3, 3>(9, 3) = ca;
    H.block<3, 3>(3, 9) = ca.transpose();
    for (int k = 3; k < 12; k += 3) {
      const Eigen::Matrix3d row = H.block<3, 3>(k, 3) + H.block<3, 3>(k, 6) + H.block<3, 3>(k, 9);
      H.block<3, 3>(k, 0) = -row;
      H.block<3, 3>(0, k) = -row.transpose();
    }
    H.block<3, 3>(0, 0) = -(H.block<3, 3>(3, 0) + H.block<3, 3>(6, 0) + H.block<3, 3>(9, 0));
    return H;
  }
};

}  // namespace vivify::sim
