#include "sim/control/keyed_weights.h"

#include <algorithm>

#include "sim/control/body_goals.h"

namespace vivify::sim {

Eigen::VectorXd weights_at(const std::vector<WeightKey>& keys, bool smooth, double t) {
  const auto next = std::upper_bound(keys.begin(), keys.end(), t,
                                     [](double at, const WeightKey& key) { return at < key.t; });
  if (next == keys.begin()) return next->weights;
  const WeightKey& from = *(next - 1);
  if (next == keys.end()) return from.weights;
  double share = (t - from.t) / (next->t - from.t);
  if (smooth) share = smooth_step(share);
  return (1 - share) * from.weights + share * next->weights;
}

}  // namespace vivify::sim
