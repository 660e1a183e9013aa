// Which elements, and which bodies, are near one another: a kept tree of boxes per surface, and a sweep over
// the boxes of all bodies.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <utility>
#include <vector>

#include "common/mesh.h"

namespace vivify::sim {

using BoundingBox = Eigen::AlignedBox3d;

// Squared distance of two boxes, m².
inline double box_distance2(const BoundingBox& a, const BoundingBox& b) {
  return (a.min() - b.max()).cwiseMax(b.min() - a.max()).cwiseMax(0.0).squaredNorm();
}

// A binary tree of axis-aligned boxes over elements (edges, triangles), built once by median splits and
// refitted when their points move.
class BoxTree {
 public:
  BoxTree() = default;
  // `elements` (#E by k) of `points` (#P by 3).
  BoxTree(const RowMatrixXi& elements, const Points& points);

  // The same tree for points that have moved, in O(#E).
  void refit(const RowMatrixXi& elements, const Points& points);
  // For points that move from `begin` to `end` in straight lines: boxes of the whole motion.
  void refit(const RowMatrixXi& elements, const Points& begin, const Points& end);

  bool empty() const { return nodes_.empty(); }
  BoundingBox box() const { return empty() ? BoundingBox() : nodes_[0].box; }

  // Calls visit(element) for all elements whose boxes are within the square root of `bound2` of p, nearer
  // branches first; visit may lower `bound2`.
  template <class Visit>
  void visit_near(const Eigen::Vector3d& p, const double& bound2, const Visit& visit) const;

  // Calls visit(element) for all elements whose boxes intersect `box`.
  template <class Visit>
  void visit_near(const BoundingBox& box, const Visit& visit) const;

  // Calls visit(element of a, element of b) for all pairs whose boxes are within `reach` of each other.
  template <class Visit>
  static void visit_pairs(const BoxTree& a, const BoxTree& b, double reach, const Visit& visit);

 private:
  // In depth-first order: the left child follows its parent.
  struct Node {
    BoundingBox box;
    int right = -1;    // the right child; −1: a leaf
    int element = -1;  // of a leaf
  };
  void build(int first, int count, std::vector<int>& order, const std::vector<Eigen::Vector3d>& centres);
  template <class BoxOf>
  void refit_boxes(const BoxOf& box_of);

  std::vector<Node> nodes_;
};

// The pairs (i < j) of boxes within `reach` of each other, sorted: by a sweep along the axis on which the
// boxes are spread most. Empty boxes are near nothing.
std::vector<std::pair<int, int>> near_boxes(const std::vector<BoundingBox>& boxes, double reach);

template <class Visit>
void BoxTree::visit_near(const Eigen::Vector3d& p, const double& bound2, const Visit& visit) const {
  if (empty()) return;
  struct Entry {
    int node;
    double distance2;
  };
  std::array<Entry, 64> stack;  // a balanced tree of 2^31 elements is no deeper
  int size = 0;
  stack[size++] = {0, nodes_[0].box.squaredExteriorDistance(p)};
  while (size > 0) {
    const Entry entry = stack[--size];
    if (entry.distance2 > bound2) continue;
    const Node& node = nodes_[entry.node];
    if (node.right < 0) {
      visit(node.element);
      continue;
    }
    Entry left{entry.node + 1, nodes_[entry.node + 1].box.squaredExteriorDistance(p)};
    Entry right{node.right, nodes_[node.right].box.squaredExteriorDistance(p)};
    if (left.distance2 <= right.distance2) std::swap(left, right);
    if (left.distance2 <= bound2) stack[size++] = left;
    if (right.distance2 <= bound2) stack[size++] = right;
  }
}

template <class Visit>
void BoxTree::visit_near(const BoundingBox& box, const Visit& visit) const {
  if (empty()) return;
  std::array<int, 64> stack;
  int size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const int i = stack[--size];
    const Node& node = nodes_[i];
    if (!node.box.intersects(box)) continue;
    if (node.right < 0) {
      visit(node.element);
    } else {
      stack[size++] = node.right;
      stack[size++] = i + 1;
    }
  }
}

template <class Visit>
void BoxTree::visit_pairs(const BoxTree& a, const BoxTree& b, double reach, const Visit& visit) {
  if (a.empty() || b.empty()) return;
  const double reach2 = reach * reach;
  std::array<std::pair<int, int>, 128> stack;
  int size = 0;
  stack[size++] = {0, 0};
  while (size > 0) {
    const auto [i, j] = stack[--size];
    const Node &u = a.nodes_[i], &v = b.nodes_[j];
    if (box_distance2(u.box, v.box) > reach2) continue;
    if (u.right < 0 && v.right < 0) {
      visit(u.element, v.element);
    } else if (v.right < 0 ||
               (u.right >= 0 && u.box.diagonal().squaredNorm() >= v.box.diagonal().squaredNorm())) {
      stack[size++] = {u.right, j};
      stack[size++] = {i + 1, j};
    } else {
      stack[size++] = {i, v.right};
      stack[size++] = {i, j + 1};
    }
  }
}

}  // namespace vivify::sim
