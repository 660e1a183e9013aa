// Fewer or more evenly spread vertices on a closed surface.
#pragma once

#include "common/mesh.h"

namespace vivify::meshing {

// Collapses edges (Garland and Heckbert 1997, plane quadrics) until `vertices` are left or nothing more may
// go. Normals do not turn by more than a right angle. The result is a closed manifold and may intersect
// itself.
TriangleMesh collapse_surface(const TriangleMesh& closed_surface, int vertices);

// Isotropic remeshing (Botsch and Kobbelt 2004) to edges of about `edge_length` metres; edges sharper than
// `sharp_angle` degrees are kept.
TriangleMesh remesh_surface(const TriangleMesh& closed_surface, double edge_length, double sharp_angle = 50);

// The same for a surface with or without borders, both finer and coarser. Borders and edges sharper than
// `sharp_angle` keep their shape but not their vertices; where they turn by more than 30 degrees a vertex
// stays.
TriangleMesh remesh_shell(const TriangleMesh& surface, double edge_length, double sharp_angle = 50);

bool intersects_itself(const TriangleMesh& surface);

}  // namespace vivify::meshing
