#include "sim/control/goal.h"

#include <Eigen/Dense>

#include "sim/control/rigid_motion.h"

namespace vivify::sim {

Goals make_goals(const std::vector<Goal>& goals, const Eigen::VectorXd& x_n, double h) {
  Goals result;
  result.G.resize(static_cast<Eigen::Index>(goals.size()), x_n.size());
  result.s.resize(static_cast<Eigen::Index>(goals.size()));
  Eigen::Index row = 0;
  for (const Goal& goal : goals) {
    const double weight = (h * goal.kp + goal.kd) / h;  // (10)
    if (weight == 0 || goal.a.isZero(0)) continue;
    const double target =
        (goal.kp * goal.sx + goal.kd * goal.sv + goal.kd / h * goal.a.dot(x_n)) / weight;  // (9)
    result.G.row(row) = weight * goal.a.transpose();
    result.s[row] = weight * target;
    ++row;
  }
  result.G.conservativeResize(row, Eigen::NoChange);
  result.s.conservativeResize(row);
  return result;
}

Eigen::VectorXd centre_of_mass_weights(const Eigen::VectorXd& mass, const Eigen::Vector3d& direction,
                                       int dimension) {
  Eigen::VectorXd a(dimension * mass.size());
  for (Eigen::Index i = 0; i < mass.size(); ++i) {
    a.segment(dimension * i, dimension) = mass[i] / mass.sum() * direction.head(dimension);
  }
  return a;
}

Eigen::VectorXd spin_weights(const Eigen::VectorXd& mass, const Eigen::VectorXd& x_n,
                             const Eigen::Vector3d& axis) {
  const int d = dimension_of(mass, x_n);
  const Eigen::Vector3d centre = centre_of_mass(mass, x_n);
  const Eigen::Vector3d row = inertia_tensor(mass, x_n).ldlt().solve(axis);
  Eigen::VectorXd a(x_n.size());
  for (Eigen::Index i = 0; i < mass.size(); ++i) {
    const Eigen::Vector3d r = spatial_point(x_n, i, d) - centre;
    a.segment(d * i, d) = mass[i] * row.cross(r).head(d);
  }
  return a;
}

}  // namespace vivify::sim
