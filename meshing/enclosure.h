// Where points lie relative to a closed triangle surface.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/mesh.h"

namespace vivify::meshing {

// The point of triangle abc that is closest to p.
Eigen::Vector3d closest_on_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                    const Eigen::Vector3d& b, const Eigen::Vector3d& c);

// Winding number of the surface around p (sum of the solid angles over 4 pi): 1 inside a closed outward
// surface, 0 outside. Van Oosterom and Strackee 1983.
double winding_number(const TriangleMesh& surface, const Eigen::Vector3d& p);

// Distance of p to the surface (metres).
double distance_to(const TriangleMesh& surface, const Eigen::Vector3d& p);

// Indices of the points that are not inside the closed outward surface, or nearer to it than `clearance`
// (metres).
std::vector<int> points_not_inside(const TriangleMesh& surface, const Points& points, double clearance = 0);

// Throws Error(geometry) that names some of the points (#P by 2 or 3) when they are not all inside the cage
// `name`, with `clearance` (metres). `not_inside(clearance)` gives the indices of those that are not.
void require_enclosed(const std::string& name, const RowMatrixXd& points, double clearance,
                      const std::function<std::vector<int>(double)>& not_inside);

// "vertices 3, 7, 8, 9, 12 and 4 more": at most five indices.
std::string list_some(const std::string& what, const std::vector<int>& indices);

}  // namespace vivify::meshing
