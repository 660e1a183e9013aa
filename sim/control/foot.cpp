#include "sim/control/foot.h"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "sim/control/body_goals.h"
#include "sim/control/rigid_motion.h"

namespace vivify::sim {

Foot::Foot(const ControlledBody& body, std::vector<int> vertices)
    : body_(body), vertices_(std::move(vertices)), mass_(Eigen::VectorXd::Zero(body.mass.size())) {
  const int d = body.dimension();
  if (d == 2) {
    mass_(vertices_) = body.mass(vertices_);
  } else {
    mass_(vertices_).setOnes();
  }
  const Eigen::Vector3d middle = centre(body.rest), way = middle - centre_of_mass(body.mass, body.rest);
  home_ = {way.x(), 0, way.z()};
  arms_.resize(static_cast<Eigen::Index>(vertices_.size()), 3);
  for (Eigen::Index k = 0; k < arms_.rows(); ++k)
    arms_.row(k) = spatial_point(body.rest, vertices_[static_cast<std::size_t>(k)], d) - middle;
  const Eigen::Matrix3d inertia = inertia_tensor(mass_, body.rest);
  size_ = std::sqrt((d == 2 ? inertia(2, 2) : inertia.trace() / 3) / mass_.sum());
}

Eigen::Vector3d Foot::centre(const Eigen::VectorXd& x) const { return centre_of_mass(mass_, x); }

double Foot::standing_height(const Eigen::VectorXd& x, double ground) const {
  return body_.dimension() == 2 ? centre(x).y() : ground - arms_.col(1).minCoeff();
}

void Foot::add_goals(const Eigen::VectorXd& x, const FootTarget& target, double kp, double kd,
                     std::vector<Goal>& goals) const {
  if (body_.dimension() == 2) {
    add_goals_in_plane(x, target, kp, kd, goals);
  } else {
    add_goals_of_sole(target, kp, kd, goals);
  }
}

void Foot::add_goals_in_plane(const Eigen::VectorXd& x, const FootTarget& target, double kp, double kd,
                              std::vector<Goal>& goals) const {
  const Eigen::Vector3d turn = upright_rate(best_rotation(mass_, body_.rest, x), target.upright);
  for (int axis = 0; axis < 2; ++axis) {
    goals.push_back({centre_of_mass_weights(mass_, Eigen::Vector3d::Unit(axis), 2), kp, kd, target.at[axis],
                     target.rate[axis]});
  }
  goals.push_back({spin_weights(mass_, x, Eigen::Vector3d::UnitZ()), 0, size_ * kd, 0, turn.z()});
}

void Foot::add_goals_of_sole(const FootTarget& target, double kp, double kd, std::vector<Goal>& goals) const {
  const double share = 1 / std::sqrt(static_cast<double>(vertices_.size()));
  for (Eigen::Index k = 0; k < arms_.rows(); ++k) {
    const Eigen::Vector3d arm = arms_.row(k);
    const Eigen::Vector3d place = target.at + Eigen::AngleAxisd(target.yaw, Eigen::Vector3d::UnitY()) * arm;
    Eigen::VectorXd vertex = Eigen::VectorXd::Zero(body_.mass.size());
    vertex[vertices_[static_cast<std::size_t>(k)]] = 1;
    for (int axis = 0; axis < 3; ++axis) {
      goals.push_back({centre_of_mass_weights(vertex, Eigen::Vector3d::Unit(axis), 3), share * kp, share * kd,
                       place[axis], target.rate[axis]});
    }
  }
}

}  // namespace vivify::sim
