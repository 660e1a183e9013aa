// Cages of eight vertices in space and four in the plane.
#pragma once

#include "common/mesh.h"

namespace vivify::meshing {

// The box of least volume around the points that stands upright (+Y), may be turned about the vertical where
// that saves at least 15 % of the volume, and whose top and bottom rectangles share a centre line but differ
// in size, in both directions independently (the smaller side is at least 0.4 of the larger one). Every point
// keeps the distance `clearance` (metres, > 0) from the faces. Vertices x + 2 y + 4 z; the face diagonals all
// join the four vertices with an even number of ones, which leaves half-turns about all three axes as
// symmetries.
TriangleMesh tapered_box(const Points& points, double clearance);

// The upright trapezium of least area around the points, of the same kind: counter-clockwise from below left.
Points2 tapered_rectangle(const Points2& points, double clearance);

}  // namespace vivify::meshing
