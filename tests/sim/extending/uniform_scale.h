// The rest shape grows and shrinks as a whole: X(p) = (1 + p) X₀ with one parameter.
#pragma once

#include "sim/rest/rest_space.h"

namespace vivify::sim {

inline std::unique_ptr<RestSpace> make_uniform_scale_space(const RestSpaceInput& input) {
  Eigen::VectorXd X0 = stack(input.reference.V, input.points);
  const Eigen::MatrixXd L = X0;
  return std::make_unique<ShapeSpace>(std::move(X0), L, Eigen::MatrixXd::Identity(1, 1), 1);
}

inline constexpr RestSpaceEntry kUniformScale = {"uniform_scale", RestLayout::compatible,
                                                 make_uniform_scale_space};

}  // namespace vivify::sim
