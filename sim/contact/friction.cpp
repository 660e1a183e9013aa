#include "sim/contact/friction.h"

namespace vivify::sim {

// Below the slip limit the gradient is (k − b |u|) u with b = k² / (4 μ f_n).

double Friction::energy(const Eigen::Vector3d& u) const {
  const double s = u.norm(), k = stiffness_;
  if (limit_ == 0) return 0;
  if (std::isinf(limit_)) return 0.5 * k * s * s;
  const double s1 = slip_limit(), b = k * k / (4 * limit_);
  if (s < s1) return 0.5 * k * s * s - b * s * s * s / 3;
  return 0.5 * k * s1 * s1 - b * s1 * s1 * s1 / 3 + limit_ * (s - s1);
}

Eigen::Vector3d Friction::gradient(const Eigen::Vector3d& u) const {
  const double s = u.norm(), k = stiffness_;
  if (limit_ == 0) return Eigen::Vector3d::Zero();
  if (std::isinf(limit_)) return k * u;
  if (s < slip_limit()) return (k - k * k / (4 * limit_) * s) * u;
  return limit_ / s * u;
}

Eigen::Matrix3d Friction::hessian(const Eigen::Vector3d& u) const {
  const double s = u.norm(), k = stiffness_;
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  if (limit_ == 0) return Eigen::Matrix3d::Zero();
  if (std::isinf(limit_) || s == 0) return k * identity;
  if (s < slip_limit()) {
    const double b = k * k / (4 * limit_);
    return (k - b * s) * identity - b / s * u * u.transpose();
  }
  return limit_ / s * (identity - u * u.transpose() / (s * s));
}

Eigen::Matrix3d Friction::third(const Eigen::Vector3d& u, const Eigen::Vector3d& w) const {
  const double s = u.norm(), k = stiffness_;
  if (limit_ == 0 || std::isinf(limit_) || s == 0) return Eigen::Matrix3d::Zero();
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d mixed = w * u.transpose() + u * w.transpose();
  const double uw = u.dot(w), s2 = s * s;
  if (s < slip_limit()) {
    const double b = k * k / (4 * limit_);
    return -b / s * (uw * identity + mixed - uw / s2 * u * u.transpose());
  }
  return -limit_ / (s * s2) * (uw * identity + mixed - 3 * uw / s2 * u * u.transpose());
}

Eigen::Vector3d Friction::return_map(const Eigen::Vector3d& u) const {
  const double s = u.norm();
  return s > slip_limit() ? Eigen::Vector3d(slip_limit() / s * u) : u;
}

}  // namespace vivify::sim
