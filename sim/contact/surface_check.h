// What must hold of a triangle surface before anything collides with it.
#pragma once

#include <string>

#include "common/mesh.h"

namespace vivify::sim {

// Throws Error(geometry), with the number of edges and the place of one, for a surface (vertices in the same
// place joined already) with
// - neighbours of opposite orientation: an edge of exactly two faces that both go along it the same way;
// - holes in a connected part that looks closed: triangles from the middle of its rim to each rim edge have
//   together less than a tenth of the part's area. Sheets, bowls and open boxes lie well above that;
// - a closed part that is oriented inward, unless it is a cavity: within the bounds of another closed part.
void check_collider_surface(const std::string& name, const TriangleMesh& surface);

}  // namespace vivify::sim
