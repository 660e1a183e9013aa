// Where the ground may push a body that stands: the convex hull of what touches it, seen from above.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace vivify::sim {

class Support {
 public:
  Support() = default;
  // Heights do not matter. At least one point; points on a line, or a single one, will do.
  explicit Support(const std::vector<Eigen::Vector3d>& points);

  // Mean of the corners.
  const Eigen::Vector3d& middle() const { return middle_; }

  // The point of the hull, shrunk by `scale` about its middle, that is nearest to p; heights are 0.
  Eigen::Vector3d nearest(const Eigen::Vector3d& p, double scale = 1) const;

 private:
  std::vector<Eigen::Vector3d> corners_;  // counter-clockwise about +y, in y = 0
  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero();
};

}  // namespace vivify::sim
