// Parts of a body that handles take hold of: the vertices in a box.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "common/error.h"
#include "common/mesh.h"
#include "common/value.h"

namespace vivify::sim {

struct Region {
  std::string handle;  // that takes hold of it, for messages: "handles[0]"
  // Opposite corners, in shares of the bounding box of the rest shape; points on the faces belong to it.
  Eigen::Vector3d min = Eigen::Vector3d::Zero();
  Eigen::Vector3d max = -Eigen::Vector3d::Ones();  // none
  std::vector<int> vertices = {};                  // that belong to it wherever they are
  Location where = {};                             // in the scene or pose file
};

// The region between the corners `min` and `max` of a setting.
Region region_between(const Value& corners, std::string handle, Location where);

// The vertices of V (#V by 2 or 3) in each region, in ascending order. Throws Error(usage) for a region
// without vertices, and for a vertex that is in two.
std::vector<std::vector<int>> held_vertices(std::span<const Region> regions, const RowMatrixXd& V);

// A place in the bounding box of V, in shares of it; z is 0 in the plane.
Eigen::Vector3d place_in_box(const RowMatrixXd& V, const Eigen::Vector3d& shares);

// Middle of the bounding box of some vertices.
Eigen::Vector3d middle_of(const RowMatrixXd& V, const std::vector<int>& vertices);

}  // namespace vivify::sim
