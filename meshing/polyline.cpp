#include "meshing/polyline.h"

#include <cmath>
#include <numbers>

#include "meshing/polygons.h"

namespace vivify::meshing {
namespace {

void mark_kept(const Points2& points, Eigen::Index first, Eigen::Index last, double tolerance,
               std::vector<char>& kept) {
  double worst = tolerance;
  Eigen::Index farthest = -1;
  for (Eigen::Index i = first + 1; i < last; ++i) {
    const double distance = distance_to_segment(points.row(i), points.row(first), points.row(last));
    if (distance > worst) {
      worst = distance;
      farthest = i;
    }
  }
  if (farthest < 0) return;
  kept[static_cast<std::size_t>(farthest)] = 1;
  mark_kept(points, first, farthest, tolerance, kept);
  mark_kept(points, farthest, last, tolerance, kept);
}

}  // namespace

std::vector<int> corners_of(const Points2& points, bool closed) {
  const auto n = static_cast<int>(points.rows());
  const Eigen::VectorXd angles = turning_angles(points);
  std::vector<int> corners;
  for (int i = 0; i < n; ++i) {
    const bool end = !closed && (i == 0 || i == n - 1);
    if (end || std::abs(angles[i]) > kCornerAngle * std::numbers::pi / 180) corners.push_back(i);
  }
  return corners;
}

Points2 section(const Points2& points, int first, int last) {
  const auto n = static_cast<int>(points.rows());
  const int steps = last > first ? last - first : last - first + n;
  Points2 part(steps + 1, 2);
  for (int i = 0; i <= steps; ++i) part.row(i) = points.row((first + i) % n);
  return part;
}

double arc_length(const Points2& points) {
  double sum = 0;
  for (Eigen::Index i = 0; i + 1 < points.rows(); ++i) sum += (points.row(i + 1) - points.row(i)).norm();
  return sum;
}

Points2 spread_evenly(const Points2& points, int count) {
  const double total = arc_length(points);
  Points2 result(count + 1, 2);
  result.row(0) = points.row(0);
  result.row(count) = points.row(points.rows() - 1);
  Eigen::Index edge = 0;
  double before = 0;  // arc length at the start of the edge
  for (int k = 1; k < count; ++k) {
    const double wanted = total * k / count;
    double length = (points.row(edge + 1) - points.row(edge)).norm();
    while (before + length < wanted && edge + 2 < points.rows()) {
      before += length;
      ++edge;
      length = (points.row(edge + 1) - points.row(edge)).norm();
    }
    const double t = length > 0 ? std::min(1.0, (wanted - before) / length) : 0;
    result.row(k) = (1 - t) * points.row(edge) + t * points.row(edge + 1);
  }
  return result;
}

std::vector<int> share_pieces(const std::vector<double>& lengths, int total) {
  std::vector<int> counts(lengths.size(), 1);
  for (int left = total - static_cast<int>(lengths.size()); left > 0; --left) {
    std::size_t longest = 0;
    for (std::size_t s = 1; s < lengths.size(); ++s) {
      // Of pieces that are equal but for round-off the first.
      if (lengths[s] / counts[s] > lengths[longest] / counts[longest] * (1 + 1e-9)) longest = s;
    }
    ++counts[longest];
  }
  return counts;
}

Points2 simplify(const Points2& points, double tolerance) {
  std::vector<char> kept(static_cast<std::size_t>(points.rows()), 0);
  kept.front() = kept.back() = 1;
  mark_kept(points, 0, points.rows() - 1, tolerance, kept);
  Points2 result(points.rows(), 2);
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    if (kept[static_cast<std::size_t>(i)] != 0) result.row(count++) = points.row(i);
  }
  return result.topRows(count);
}

}  // namespace vivify::meshing
