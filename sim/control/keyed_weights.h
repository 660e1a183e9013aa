// Weights of examples over time: keyframes and what is between them.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace vivify::sim {

struct WeightKey {
  double t;  // s
  Eigen::VectorXd weights;
};

// At least one key, in the order of time. Before the first and after the last the weights stay. `smooth`:
// slow at both ends of an interval, instead of at a constant rate.
Eigen::VectorXd weights_at(const std::vector<WeightKey>& keys, bool smooth, double t);

}  // namespace vivify::sim
