// Polygons in the plane: area, filling of crossing contours, offsets, and which points they hold.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <utility>
#include <vector>

#include "common/mesh.h"

namespace vivify::meshing {

inline double cross2(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Area (m²) of a closed polygon; positive when it runs counter-clockwise.
double signed_area(const Points2& polygon);
double perimeter(const Points2& polygon);

Eigen::AlignedBox2d box_of(const std::vector<Points2>& polygons);
Eigen::AlignedBox2d box_of(const Points2& points);

// Angle (radians) by which the closed polygon turns left at each of its vertices, in (−π, π].
Eigen::VectorXd turning_angles(const Points2& polygon);

enum class FillRule { nonzero, even_odd };

// The boundary of what the contours fill: loops that neither cross nor overlap (they may touch in single
// points), outer ones counter-clockwise and holes clockwise, without repeated and collinear points, the
// largest first, each from its lowest leftmost vertex. Points that stay keep their bits. Loops below 1e-9 of
// the area of the bounding box are dropped.
std::vector<Points2> fill(const std::vector<Points2>& contours, FillRule rule);

// The filled area of `loops` (as fill() gives them) grown by `distance` (metres; shrunk when negative), with
// round corners that are off by at most `tolerance`.
std::vector<Points2> offset(const std::vector<Points2>& loops, double distance, double tolerance);

// Winding number of the loops around p; exact for points that are not on them.
int winding_number(const std::vector<Points2>& loops, const Eigen::Vector2d& p);

double distance_to_segment(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b);
double distance_to(const std::vector<Points2>& loops, const Eigen::Vector2d& p);

// Indices of the points that are not inside the simple counter-clockwise polygon, or nearer to it than
// `clearance` (metres); points on it are not inside.
std::vector<int> points_not_inside(const Points2& polygon, const Points2& points, double clearance = 0);

// Whether the closed segments ab and cd have a point in common.
bool segments_meet(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                   const Eigen::Vector2d& d);

// Two edges (numbered over all loops) that meet although they are not neighbours, or neighbours that overlap;
// (-1, -1) when the loops are simple and apart from each other.
std::pair<int, int> meeting_edges(const std::vector<Points2>& loops);

}  // namespace vivify::meshing
