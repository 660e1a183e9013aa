// How colliders and handles move: a rigid motion through keyframes.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "common/error.h"

namespace vivify::sim {

// Fastest mean motion between two keyframes that is not a mistake.
inline constexpr double kFastestTravel = 100;  // m/s
inline constexpr double kFastestTurn = 3600;   // °/s

struct RigidKey {
  double t = 0;                                        // s
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
  Eigen::Vector3d turns_deg =
      Eigen::Vector3d::Zero();  // about the x, then the y, then the z axis of the world
  Location where;               // in the scene file
};

// Each coordinate and each angle runs through its keys as a monotone cubic (Fritsch and Butland 1984): its
// velocity is continuous, and between two keys it never leaves their range. Angles are interpolated as they
// are given, not as quaternions, because two keys can then ask for whole turns. Before the first key and
// after the last one the pose stays, so the velocity is zero at both; a path that repeats goes on with the
// same velocity instead.
class RigidPath {
 public:
  RigidPath() = default;  // rests at the identity
  // `repeats`: the time between the first and the last key is a period. Throws Error(usage) with the place
  // of the key for times that do not increase, keys farther apart than the fastest motion allows, and a
  // repeated path whose end is not its beginning (whole turns aside); `name` is for messages.
  RigidPath(std::vector<RigidKey> keys, bool repeats, const std::string& name = "motion");

  bool moves() const { return !keys_.empty(); }
  Eigen::Isometry3d pose(double t) const;

 private:
  using Coordinates = Eigen::Matrix<double, 6, 1>;  // position, angles in degrees

  static Coordinates coordinates(const RigidKey& key);
  void check(const std::string& name) const;
  Coordinates at(double t) const;

  std::vector<RigidKey> keys_;
  std::vector<Coordinates> velocity_;  // at the keys
  bool repeats_ = false;
};

}  // namespace vivify::sim
