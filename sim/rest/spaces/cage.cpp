#include "sim/rest/rest_space.h"

namespace vivify::sim {

std::unique_ptr<RestSpace> make_cage_space(const RestSpaceInput& input) {
  const RowMatrixXd& V = input.reference.V;
  const Eigen::MatrixXd& weights = input.cage_weights;
  const Eigen::Index d = V.cols();
  if (weights.rows() != V.rows()) {
    throw Error(ErrorKind::internal, "cage weights are of another mesh");
  }
  Eigen::MatrixXd L = Eigen::MatrixXd::Zero(d * V.rows(), d * weights.cols());
  for (Eigen::Index i = 0; i < weights.rows(); ++i) {
    for (Eigen::Index c = 0; c < weights.cols(); ++c) {
      L.block(d * i, d * c, d, d).diagonal().setConstant(weights(i, c));
    }
  }
  Eigen::VectorXd X0 = stack(V, input.points);
  Eigen::MatrixXd basis = shape_changing_basis(X0, L, input.reference.dimension());
  return std::make_unique<ShapeSpace>(std::move(X0), L, std::move(basis), unit_length(V));
}

}  // namespace vivify::sim
