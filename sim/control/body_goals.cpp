#include "sim/control/body_goals.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/control/rigid_motion.h"

namespace vivify::sim {

constexpr double kTouchLoad = 0.05;  // share of the weight that counts as standing on the ground

void BodyGoals::centre(const Eigen::Vector3d& direction, double weight, double frequency, double sx,
                       double sv) {
  const double kd = std::sqrt(weight * body_.mass.sum());
  goals_.push_back(
      {centre_of_mass_weights(body_.mass, direction, body_.dimension()), frequency * kd, kd, sx, sv});
}

void BodyGoals::spin(double weight, const Eigen::Vector3d& rate) {
  if (weight == 0) return;
  const Eigen::Matrix3d inertia = inertia_tensor(body_.mass, x_);
  const bool planar = body_.dimension() == 2;
  const double kd = std::sqrt(weight * (planar ? inertia(2, 2) : inertia.trace() / 3));
  for (int axis = planar ? 2 : 0; axis < 3; ++axis) {
    goals_.push_back({spin_weights(body_.mass, x_, Eigen::Vector3d::Unit(axis)), 0, kd, 0, rate[axis]});
  }
}

Eigen::Vector3d upright_rate(const Eigen::Matrix3d& R, double frequency) {
  return frequency * (R * Eigen::Vector3d::UnitY()).cross(Eigen::Vector3d::UnitY());
}

double yaw_of(const Eigen::Matrix3d& R) {
  const Eigen::Vector3d front = R * Eigen::Vector3d::UnitZ();
  return std::atan2(front.x(), front.z());
}

double nearest_turn(double angle) { return std::remainder(angle, 2 * std::numbers::pi); }

double rest_rise(const ControlledBody& body) {
  return centre_of_mass(body.mass, body.rest).y() - lowest_height(body.rest, body.dimension());
}

bool stands(const ControlledBody& body, double load) {
  return load > kTouchLoad * body.mass.sum() * body.gravity;
}

double smooth_step(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

}  // namespace vivify::sim
