#include "sim/control/rigid_motion.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "common/matrix.h"

namespace vivify::sim {

double lowest_height(const Eigen::VectorXd& x, int d) {
  return Eigen::Map<const RowMatrixXd>(x.data(), x.size() / d, d).col(1).minCoeff();
}

Eigen::Vector3d centre_of_mass(const Eigen::VectorXd& mass, const Eigen::VectorXd& x) {
  const int d = dimension_of(mass, x);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < mass.size(); ++i) sum += mass[i] * spatial_point(x, i, d);
  return sum / mass.sum();
}

Eigen::Matrix3d inertia_tensor(const Eigen::VectorXd& mass, const Eigen::VectorXd& x) {
  const int d = dimension_of(mass, x);
  const Eigen::Vector3d centre = centre_of_mass(mass, x);
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for (Eigen::Index i = 0; i < mass.size(); ++i) {
    const Eigen::Vector3d r = spatial_point(x, i, d) - centre;
    inertia += mass[i] * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
  }
  return inertia;
}

Eigen::Vector3d angular_momentum(const Eigen::VectorXd& mass, const Eigen::VectorXd& x,
                                 const Eigen::VectorXd& v) {
  const int d = dimension_of(mass, x);
  const Eigen::Vector3d centre = centre_of_mass(mass, x);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < mass.size(); ++i) {
    const Eigen::Vector3d r = spatial_point(x, i, d) - centre, vi = spatial_point(v, i, d);
    sum += mass[i] * r.cross(vi);
  }
  return sum;
}

Eigen::Matrix3d best_rotation(const Eigen::VectorXd& mass, const Eigen::VectorXd& rest,
                              const Eigen::VectorXd& x) {
  const int d = dimension_of(mass, x);
  const Eigen::Vector3d rest_centre = centre_of_mass(mass, rest), centre = centre_of_mass(mass, x);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (Eigen::Index i = 0; i < mass.size(); ++i) {
    covariance +=
        mass[i] * (spatial_point(x, i, d) - centre) * (spatial_point(rest, i, d) - rest_centre).transpose();
  }
  // What is in the plane stays there, lines and mirrored shapes too: no smallest singular value is beside it.
  if (d == 2) covariance(2, 2) = 2 * covariance.cwiseAbs().maxCoeff();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  signs[2] = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

}  // namespace vivify::sim
