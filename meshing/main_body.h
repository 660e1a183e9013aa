// The part of a drawn surface that is simulated.
#pragma once

#include <string>
#include <vector>

#include "common/mesh.h"

namespace vivify::meshing {

// Leaves out small decoration (eyes set into a face, buttons): connected parts that hold less than 2 % of the
// volume of the largest part and lie within its bounding box grown by a tenth, when that part is closed by
// itself. Decoration is drawn and moves with the body, but its intersections with the body need no repair.
// Adds a note when it left any out.
TriangleMesh main_body(const TriangleMesh& surface, std::vector<std::string>& notes);

}  // namespace vivify::meshing
