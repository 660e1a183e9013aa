// Pushes of a body as a whole, from outside: forces on its mass that its controller does not know of.
#pragma once

#include <Eigen/Core>
#include <span>

namespace vivify::sim {

// The force is constant from `begin` for `duration` > 0, and is the impulse over that time.
struct Push {
  double begin;             // s
  double duration;          // s
  Eigen::Vector3d impulse;  // N s
};

// The part of the impulses that falls between two times, N s: summed over the steps of any size, all of them.
Eigen::Vector3d impulse_between(std::span<const Push> pushes, double from, double to);

}  // namespace vivify::sim
