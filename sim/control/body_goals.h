// Goals that controllers share: of the centre of mass and of the orientation of a body.
#pragma once

#include <vector>

#include "sim/control/controller.h"

namespace vivify::sim {

// The goals of one step for a body that is at x (d #V).
class BodyGoals {
 public:
  BodyGoals(const ControlledBody& body, const Eigen::VectorXd& x) : body_(body), x_(x) {}

  // Along `direction` (unit) the centre of mass shall be at sx (m, k_p = `frequency` k_d, 1/s) and go at sv
  // (m/s). k_d² = `weight` M.
  void centre(const Eigen::Vector3d& direction, double weight, double frequency, double sx, double sv);

  // The body as a whole shall turn at `rate` (1/s) about every axis it can. k_d² = `weight` × its mean
  // inertia.
  void spin(double weight, const Eigen::Vector3d& rate);

  std::vector<Goal> take() { return std::move(goals_); }

 private:
  const ControlledBody& body_;
  const Eigen::VectorXd& x_;
  std::vector<Goal> goals_;
};

// Rate that turns a body with the orientation R upright at `frequency` (1/s) per radian of tilt. About the
// vertical it is 0.
Eigen::Vector3d upright_rate(const Eigen::Matrix3d& R, double frequency);

// The angle about the vertical by which R turns what looks along +z, −π to π.
double yaw_of(const Eigen::Matrix3d& R);

// The same direction as an angle from −π to π.
double nearest_turn(double angle);

// How high the centre of mass is above the lowest vertex at rest, m.
double rest_rise(const ControlledBody& body);

// Whether a body with this load (N) stands on something.
bool stands(const ControlledBody& body, double load);

// 0 before 0, 1 after 1, smooth in between.
double smooth_step(double t);

}  // namespace vivify::sim
