// The motion of a deformable body as a whole: centre, velocity, inertia and orientation.
#pragma once

#include <Eigen/Core>

namespace vivify::sim {

// Positions and velocities are flat (d #V, d = 2 or 3), mass is #V; bodies of the plane lie in z = 0.

// Point i of a flat vector with d coordinates per point.
inline Eigen::Vector3d spatial_point(const Eigen::VectorXd& x, Eigen::Index i, int d) {
  return d == 3 ? Eigen::Vector3d(x.segment<3>(3 * i)) : Eigen::Vector3d(x[2 * i], x[2 * i + 1], 0);
}
inline int dimension_of(const Eigen::VectorXd& mass, const Eigen::VectorXd& x) {
  return static_cast<int>(x.size() / mass.size());
}

// Height of the lowest point of a flat vector with d coordinates per point.
double lowest_height(const Eigen::VectorXd& x, int d);

Eigen::Vector3d centre_of_mass(const Eigen::VectorXd& mass, const Eigen::VectorXd& x);
Eigen::Matrix3d inertia_tensor(const Eigen::VectorXd& mass, const Eigen::VectorXd& x);
Eigen::Vector3d angular_momentum(const Eigen::VectorXd& mass, const Eigen::VectorXd& x,
                                 const Eigen::VectorXd& v);

// The rotation R that best maps the rest shape to x, min Σ m_i |R (X_i − X_c) − (x_i − x_c)|² (Horn 1987; by
// SVD).
Eigen::Matrix3d best_rotation(const Eigen::VectorXd& mass, const Eigen::VectorXd& rest,
                              const Eigen::VectorXd& x);

}  // namespace vivify::sim
