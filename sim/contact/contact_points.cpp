#include "sim/contact/contact_points.h"

#include <algorithm>
#include <cmath>

namespace vivify::sim {
namespace {

constexpr double kFootHeight = 0.01;  // share of the height

// Appends up to `count` of the candidates to `chosen`, each farthest from all chosen before it; ties go to
// the lower index.
void sample_farthest(const Points& surface, const std::vector<int>& candidates, int count,
                     std::vector<int>& chosen) {
  std::vector<double> distance2(candidates.size(), INFINITY);
  const auto account_for = [&](int point) {
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      distance2[k] = std::min(distance2[k], (surface.row(candidates[k]) - surface.row(point)).squaredNorm());
    }
  };
  for (const int point : chosen) account_for(point);
  for (int n = 0; n < count && !candidates.empty(); ++n) {
    const auto farthest = std::max_element(distance2.begin(), distance2.end());
    if (*farthest == 0) break;
    chosen.push_back(candidates[static_cast<std::size_t>(farthest - distance2.begin())]);
    account_for(chosen.back());
  }
}

}  // namespace

ContactPoints select_contact_points(const Points& surface, const RowMatrixXi& vertices,
                                    const RowMatrixXd& weights, int dimension, int count) {
  const Box box = bounding_box(surface);
  const double foot = box.min.y() + kFootHeight * (box.max.y() - box.min.y());
  std::vector<int> low, all;
  for (int i = 0; i < surface.rows(); ++i) {
    all.push_back(i);
    if (surface(i, 1) <= foot) low.push_back(i);
  }
  std::vector<int> chosen;
  sample_farthest(surface, low, count / 2, chosen);
  sample_farthest(surface, all, count - static_cast<int>(chosen.size()), chosen);
  ContactPoints points;
  points.dimension = dimension;
  points.vertices.resize(static_cast<Eigen::Index>(chosen.size()), vertices.cols());
  points.weights.resize(static_cast<Eigen::Index>(chosen.size()), weights.cols());
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    points.vertices.row(static_cast<Eigen::Index>(k)) = vertices.row(chosen[k]);
    points.weights.row(static_cast<Eigen::Index>(k)) = weights.row(chosen[k]);
  }
  return points;
}

int count_standing_points(const ContactPoints& points, const Eigen::VectorXd& rest) {
  std::vector<double> heights;
  for (int i = 0; i < points.size(); ++i) heights.push_back(points.position(i, rest).y());
  if (heights.empty()) return 0;
  const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
  const double foot = *low + kFootHeight * (*high - *low);
  return static_cast<int>(std::count_if(heights.begin(), heights.end(), [&](double y) { return y <= foot; }));
}

}  // namespace vivify::sim
