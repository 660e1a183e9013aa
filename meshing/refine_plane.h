// Triangles of good shape between segments in the plane (Delaunay refinement, Ruppert 1995 and Shewchuk
// 2002).
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "common/mesh.h"

namespace vivify::meshing {

struct RefineSettings {
  double longest_edge = 0;  // metres; 0: no bound
  // Bound on the smallest angle: sin² of it; 0.125 is 20.7°, the largest for which refinement surely ends.
  // Angles between given segments may be smaller.
  double least_sine_squared = 0.125;
  Eigen::Index most_vertices = 1000000;
};

struct PlaneTriangles {
  Points2 V;
  Triangles F;            // counter-clockwise
  Eigen::VectorXi point;  // #P, vertex of each given point; the first #P vertices unless some coincide
};

// Triangulates what the segments (#S by 2 into points) bound, by parity, with all points as vertices, and
// refines. Points outside are left out of F. Further vertices follow in the order of their coordinates.
// Nothing when it would take more than `most_vertices`. Throws Error(geometry) when the segments bound
// nothing.
std::optional<PlaneTriangles> refine_plane(const Points2& points, const Edges& segments,
                                           const RefineSettings& settings);

// The same for closed loops, whose vertices are the points in order.
std::optional<PlaneTriangles> refine_plane(const std::vector<Points2>& loops, const RefineSettings& settings);

// The vertex that follows each boundary vertex along the boundary, with the triangles on its left. Where the
// boundary touches itself, one of them.
std::map<int, int> next_on_boundary(const Triangles& F);

}  // namespace vivify::meshing
