#include "sim/rest/rest_space.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <Eigen/SVD>

namespace vivify::sim {

Eigen::MatrixXd shape_changing_basis(const Eigen::VectorXd& X0, const Eigen::MatrixXd& L) {
  const Eigen::Index points = X0.size() / 3, parameters = L.cols();
  Eigen::MatrixXd rigid = Eigen::MatrixXd::Zero(X0.size(), 6);
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < points; ++i) centre += X0.segment<3>(3 * i) / static_cast<double>(points);
  for (Eigen::Index i = 0; i < points; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      rigid(3 * i + axis, axis) = 1;
      rigid.block<3, 1>(3 * i, 3 + axis) = Eigen::Vector3d::Unit(axis).cross(X0.segment<3>(3 * i) - centre);
    }
  }
  // Parameters that produce each rigid motion, kept where L really can produce it.
  const auto least_squares = L.colPivHouseholderQr();
  Eigen::MatrixXd null_parameters(parameters, 0);
  for (int motion = 0; motion < 6; ++motion) {
    const Eigen::VectorXd p = least_squares.solve(rigid.col(motion));
    if ((L * p - rigid.col(motion)).norm() < 1e-6 * rigid.col(motion).norm()) {
      null_parameters.conservativeResize(Eigen::NoChange, null_parameters.cols() + 1);
      null_parameters.rightCols<1>() = p;
    }
  }
  if (null_parameters.cols() == 0) return Eigen::MatrixXd::Identity(parameters, parameters);
  const Eigen::MatrixXd Q = Eigen::HouseholderQR<Eigen::MatrixXd>(null_parameters).householderQ();
  return Q.rightCols(parameters - null_parameters.cols());
}

RestSpace make_cage_space(const Points& rest, const Eigen::MatrixXd& weights) {
  RestSpace space;
  space.type = "cage";
  space.X0.resize(3 * rest.rows());
  for (Eigen::Index i = 0; i < rest.rows(); ++i) space.X0.segment<3>(3 * i) = rest.row(i).transpose();
  space.L = Eigen::MatrixXd::Zero(3 * rest.rows(), 3 * weights.cols());
  for (Eigen::Index i = 0; i < weights.rows(); ++i) {
    for (Eigen::Index c = 0; c < weights.cols(); ++c) {
      space.L.block<3, 3>(3 * i, 3 * c) = weights(i, c) * Eigen::Matrix3d::Identity();
    }
  }
  space.basis = shape_changing_basis(space.X0, space.L);
  space.Lq = space.L * space.basis;
  return space;
}

}  // namespace vivify::sim
