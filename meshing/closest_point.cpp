#include "meshing/closest_point.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "meshing/enclosure.h"

namespace vivify::meshing {
namespace {

constexpr int kLeafSize = 4;

}  // namespace

ClosestPoint::ClosestPoint(TriangleMesh surface) : surface_(std::move(surface)) {
  const auto count = static_cast<int>(surface_.F.rows());
  std::vector<Eigen::Vector3d> centres(static_cast<std::size_t>(count));
  for (int f = 0; f < count; ++f) {
    centres[static_cast<std::size_t>(f)] =
        (surface_.V.row(surface_.F(f, 0)) + surface_.V.row(surface_.F(f, 1)) +
         surface_.V.row(surface_.F(f, 2))) /
        3;
  }
  order_.resize(static_cast<std::size_t>(count));
  std::iota(order_.begin(), order_.end(), 0);
  if (count > 0) build(0, count, centres);
}

int ClosestPoint::build(int first, int count, std::vector<Eigen::Vector3d>& centres) {
  const auto id = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  Node node;
  Eigen::AlignedBox3d spread;
  for (int i = first; i < first + count; ++i) {
    const int f = order_[static_cast<std::size_t>(i)];
    for (int k = 0; k < 3; ++k) node.box.extend(surface_.V.row(surface_.F(f, k)).transpose());
    spread.extend(centres[static_cast<std::size_t>(f)]);
  }
  if (count <= kLeafSize) {
    node.first = first;
    node.count = count;
  } else {
    Eigen::Index axis = 0;
    spread.sizes().maxCoeff(&axis);
    const int half = count / 2;
    const auto begin = order_.begin() + first;
    std::nth_element(begin, begin + half, begin + count, [&](int a, int b) {
      const double u = centres[static_cast<std::size_t>(a)][axis],
                   v = centres[static_cast<std::size_t>(b)][axis];
      return u < v || (u == v && a < b);
    });
    node.left = build(first, half, centres);
    node.right = build(first + half, count - half, centres);
  }
  nodes_[static_cast<std::size_t>(id)] = node;
  return id;
}

void ClosestPoint::search(int id, const Eigen::Vector3d& x, Hit& best) const {
  const Node& node = nodes_[static_cast<std::size_t>(id)];
  for (int i = node.first; i < node.first + node.count; ++i) {
    const int f = order_[static_cast<std::size_t>(i)];
    const Eigen::Vector3d p =
        closest_on_triangle(x, surface_.V.row(surface_.F(f, 0)), surface_.V.row(surface_.F(f, 1)),
                            surface_.V.row(surface_.F(f, 2)));
    const double distance = (p - x).norm();
    if (distance < best.distance) best = {p, distance, f};
  }
  if (node.left < 0) return;
  int near = node.left, far = node.right;
  double near_distance = nodes_[static_cast<std::size_t>(near)].box.exteriorDistance(x);
  double far_distance = nodes_[static_cast<std::size_t>(far)].box.exteriorDistance(x);
  if (far_distance < near_distance) {
    std::swap(near, far);
    std::swap(near_distance, far_distance);
  }
  if (near_distance < best.distance) search(near, x, best);
  if (far_distance < best.distance) search(far, x, best);
}

ClosestPoint::Hit ClosestPoint::operator()(const Eigen::Vector3d& x) const {
  Hit best = {x, std::numeric_limits<double>::infinity(), -1};
  if (!nodes_.empty()) search(0, x, best);
  return best;
}

}  // namespace vivify::meshing
