#include "sim/push.h"

#include <algorithm>

namespace vivify::sim {

Eigen::Vector3d impulse_between(std::span<const Push> pushes, double from, double to) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Push& push : pushes) {
    const double shared = std::min(to, push.begin + push.duration) - std::max(from, push.begin);
    if (shared > 0) sum += shared / push.duration * push.impulse;
  }
  return sum;
}

}  // namespace vivify::sim
