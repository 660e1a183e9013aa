#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "sim/rest/registration.h"
#include "sim/rest/rest_space.h"

namespace vivify::sim {

// Equation (12): column k of L holds X̂_k − X₀ with every element of pose k registered to its rest element.
std::unique_ptr<RestSpace> make_examples_space(const RestSpaceInput& input) {
  Eigen::VectorXd X0 = stack(input.reference.V, input.points);
  Eigen::MatrixXd L(X0.size(), static_cast<Eigen::Index>(input.examples.size()));
  for (std::size_t k = 0; k < input.examples.size(); ++k) {
    const ExamplePose& pose = input.examples[k];
    check_pose(pose, input.reference);
    L.col(static_cast<Eigen::Index>(k)) = register_elements(stack(pose.V, input.points), X0, input.points,
                                                            input.reference.dimension(), pose.name) -
                                          X0;
  }
  const Eigen::MatrixXd weights = Eigen::MatrixXd::Identity(L.cols(), L.cols());
  return std::make_unique<ShapeSpace>(std::move(X0), L, weights, 1, weights, example_groups(input.examples));
}

}  // namespace vivify::sim
