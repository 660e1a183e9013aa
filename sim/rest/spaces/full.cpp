// Every vertex of the rest shape is free: equation (2) of Coros et al. 2012 without a parameterisation.
#include "sim/rest/rest_space.h"

namespace vivify::sim {

std::unique_ptr<RestSpace> make_full_space(const RestSpaceInput& input) {
  Eigen::VectorXd X0 = stack(input.reference.V, input.points);
  const Eigen::MatrixXd L = Eigen::MatrixXd::Identity(X0.size(), X0.size());
  Eigen::MatrixXd basis = shape_changing_basis(X0, L, input.reference.dimension());
  return std::make_unique<ShapeSpace>(std::move(X0), L, std::move(basis), unit_length(input.reference.V));
}

}  // namespace vivify::sim
