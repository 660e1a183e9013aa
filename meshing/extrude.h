// Solid letters: outlines pushed out into space, for drawing 2-D characters.
#pragma once

#include "common/mesh.h"
#include "meshing/outline.h"

namespace vivify::meshing {

// A closed, manifold, outward surface between z = -depth/2 and z = depth/2 (metres) whose front and back are
// flat and whose edges are rounded with the radius `bevel` (0: sharp; less where strokes are too thin for it,
// which is logged). Its parts are "front", "side" (with the round edges) and "back". Edges are at most about
// depth/2 long, so that the surface bends smoothly. A picture on it fills the box around the outline. Throws
// Error(geometry) when the bevel is not less than half of the depth.
TriangleMesh extrude(const Outline& outline, double depth, double bevel);

}  // namespace vivify::meshing
