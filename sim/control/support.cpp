#include "sim/control/support.h"

#include <algorithm>
#include <limits>

namespace vivify::sim {
namespace {

// Twice the area of the triangle, positive when a, b, c turn from z to x.
double turn(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  return (b.z() - a.z()) * (c.x() - a.x()) - (b.x() - a.x()) * (c.z() - a.z());
}

Eigen::Vector3d nearest_on_segment(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                   const Eigen::Vector3d& p) {
  const double length2 = (b - a).squaredNorm();
  const double t = length2 > 0 ? std::clamp((p - a).dot(b - a) / length2, 0.0, 1.0) : 0;
  return a + t * (b - a);
}

}  // namespace

// Andrew's monotone chain.
Support::Support(const std::vector<Eigen::Vector3d>& points) {
  std::vector<Eigen::Vector3d> sorted = points;
  for (Eigen::Vector3d& point : sorted) point.y() = 0;
  std::sort(sorted.begin(), sorted.end(),
            [](const auto& a, const auto& b) { return a.z() != b.z() ? a.z() < b.z() : a.x() < b.x(); });
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  for (int side = 0; side < 2; ++side) {
    const std::size_t first = corners_.size();
    for (const Eigen::Vector3d& point : sorted) {
      while (corners_.size() >= first + 2 && turn(corners_[corners_.size() - 2], corners_.back(), point) <= 0)
        corners_.pop_back();
      corners_.push_back(point);
    }
    if (sorted.size() > 1) corners_.pop_back();  // it begins the other side
    std::reverse(sorted.begin(), sorted.end());
    if (sorted.size() == 1) break;
  }
  middle_.setZero();
  for (const Eigen::Vector3d& corner : corners_) middle_ += corner / static_cast<double>(corners_.size());
}

Eigen::Vector3d Support::nearest(const Eigen::Vector3d& p, double scale) const {
  const Eigen::Vector3d level(p.x(), 0, p.z());
  bool inside = corners_.size() > 2;
  Eigen::Vector3d best = middle_;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const Eigen::Vector3d a = middle_ + scale * (corners_[i] - middle_),
                          b = middle_ + scale * (corners_[(i + 1) % corners_.size()] - middle_);
    inside = inside && turn(a, b, level) >= 0;
    const Eigen::Vector3d q = nearest_on_segment(a, b, level);
    if ((q - level).squaredNorm() < least) {
      least = (q - level).squaredNorm();
      best = q;
    }
  }
  return inside ? level : best;
}

}  // namespace vivify::sim
