// Anchored friction: a spring from the anchor where the point first touched, limited by Coulomb's μ f_n with
// the normal force f_n of the step before. With slip u = |tangential offset| and y = u / 2u*, u* = μ f_n /
// k_t, the force is
//   μ f_n (2y − y²) while y < 1 (sticks), μ f_n beyond (slips):
// once differentiable at the switch. Infinite μ gives the paper's unlimited spring k_t u.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace vivify::sim {

// The part of v across the unit vector `normal`.
inline Eigen::Vector3d tangential(const Eigen::Vector3d& normal, const Eigen::Vector3d& v) {
  return v - normal * normal.dot(v);
}

class Friction {
 public:
  // `stiffness` k_t in N/m, `limit` μ f_n in N (may be infinite; zero means no friction).
  Friction(double stiffness, double limit) : stiffness_(stiffness), limit_(limit) {}

  // Slip beyond which the force is at its limit, 2u* (m).
  double slip_limit() const { return std::isinf(limit_) ? INFINITY : 2 * limit_ / stiffness_; }

  // Dissipated energy U of the tangential offset u (J), and its derivatives with respect to u.
  double energy(const Eigen::Vector3d& u) const;
  Eigen::Vector3d gradient(const Eigen::Vector3d& u) const;
  Eigen::Matrix3d hessian(const Eigen::Vector3d& u) const;
  Eigen::Matrix3d third(const Eigen::Vector3d& u,
                        const Eigen::Vector3d& w) const;  // d/dε Hessian(u + ε w) at 0

  // The offset after the step: an anchor is dragged along when the point slips (return map).
  Eigen::Vector3d return_map(const Eigen::Vector3d& u) const;

 private:
  double stiffness_;
  double limit_;
};

}  // namespace vivify::sim
