// Cages: coarse closed surfaces around a character that carry its rest shape (Coros et al. 2012).
#pragma once

#include <string>

#include "common/mesh.h"
#include "common/schema.h"

namespace vivify::meshing {

struct CageSettings {
  int vertices = 8;         // wanted number for an automatic cage
  double clearance = 0.02;  // least distance to the enclosed points, over the diagonal of their bounding box
};

// The fields `vertices`, `clearance` and `file`, a mesh to check with validate_cage instead of making a cage.
Schema cage_schema();
CageSettings cage_settings(const Value& value);

// A cage around the points (vertices of the simulation mesh) and the surface (closed, for example repaired),
// that is made automatically: other numbers than eight wrap the surface and collapse edges
// around it down to the wanted number, or as near to it as is legal (logged). Eight vertices give an upright
// tapered box: it keeps the symmetry of the character, and at equal clearance cages that were collapsed to
// eight were skew and 17 to 64 % larger (sphere, torus, two balls, box, U, tea cup).
// Throws Error(geometry) when no valid cage was found.
TriangleMesh make_cage(const Points& must_enclose, const TriangleMesh& surface, const CageSettings& settings);

// Checks a cage, and returns it facing outward, with vertices in the same place joined (files split them at
// texture seams): closed, manifold, free of self-intersections, all points
// strictly inside with `clearance` (metres). Throws Error(geometry) that says what is wrong, where, and what
// to do; `name` names the cage in it.
TriangleMesh validate_cage(TriangleMesh cage, const Points& must_enclose, double clearance = 0,
                           const std::string& name = "the cage");

}  // namespace vivify::meshing
