// Closest points on a triangle surface, by a tree of bounding boxes.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "common/mesh.h"

namespace vivify::meshing {

class ClosestPoint {
 public:
  explicit ClosestPoint(TriangleMesh surface);

  struct Hit {
    Eigen::Vector3d point;
    double distance;
    int triangle;
  };
  // The point of the surface that is closest to x; of several triangles the first in the order of the tree.
  Hit operator()(const Eigen::Vector3d& x) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    int first = 0, count = 0;   // of a leaf: range in order_
    int left = -1, right = -1;  // of an inner node
  };
  int build(int first, int count, std::vector<Eigen::Vector3d>& centres);
  void search(int node, const Eigen::Vector3d& x, Hit& best) const;

  TriangleMesh surface_;
  std::vector<int> order_;
  std::vector<Node> nodes_;
};

}  // namespace vivify::meshing
