// Cages in the plane: polygons around a 2-D character.
#pragma once

#include <string>

#include "common/mesh.h"
#include "meshing/cage.h"
#include "meshing/outline.h"

namespace vivify::meshing {

// A simple counter-clockwise polygon around the points and the outline that keeps the clearance of the
// settings (over the diagonal of their bounding box) from the points. Four vertices give an upright trapezium
// that is symmetric about a vertical line; other numbers (at least 3) start from the outline moved outward,
// and edges and notches are filled up, the least area first, until the wanted number is left or as near to it
// as is legal (logged). Throws Error(geometry) when there is no point.
Points2 make_planar_cage(const Points2& must_enclose, const Outline& outline, const CageSettings& settings);

// Checks a cage, and returns it counter-clockwise: finite, simple, all points strictly inside with
// `clearance` (metres). Throws Error(geometry) that says what is wrong, where, and what to do; `name` names
// the cage in it.
Points2 validate_planar_cage(Points2 cage, const Points2& must_enclose, double clearance = 0,
                             const std::string& name = "the cage");

}  // namespace vivify::meshing
