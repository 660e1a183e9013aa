// Polylines for 2-D rods.
#pragma once

#include "common/mesh.h"

namespace vivify::meshing {

struct Rod {
  Points2 V;  // in order along the rod
  Edges E;    // vertex to next vertex; the last edge of a closed rod leads back to vertex 0
};

// `vertices` points along the polyline at nearly equal arc length; its ends and its corners (turns by more
// than 30 degrees) are vertices. A closed polyline without corners starts at its first point. Throws
// Error(geometry) when the polyline has a point that is not finite, no length or more corners than
// `vertices` allow.
Rod rod_from_polyline(const Points2& points, bool closed, int vertices);

}  // namespace vivify::meshing
