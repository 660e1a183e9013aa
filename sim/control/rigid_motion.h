// The motion of a deformable body as a whole: centre, velocity, inertia and orientation.
#pragma once

#include <Eigen/Core>

namespace vivify::sim {

// Positions and velocities are flat (3 #V), mass is #V.
Eigen::Vector3d centre_of_mass(const Eigen::VectorXd& mass, const Eigen::VectorXd& x);
Eigen::Matrix3d inertia_tensor(const Eigen::VectorXd& mass, const Eigen::VectorXd& x);
Eigen::Vector3d angular_momentum(const Eigen::VectorXd& mass, const Eigen::VectorXd& x,
                                 const Eigen::VectorXd& v);

// The rotation R that best maps the rest shape to x, min Σ m_i |R (X_i − X_c) − (x_i − x_c)|² (Horn 1987; by
// SVD).
Eigen::Matrix3d best_rotation(const Eigen::VectorXd& mass, const Eigen::VectorXd& rest,
                              const Eigen::VectorXd& x);

}  // namespace vivify::sim
