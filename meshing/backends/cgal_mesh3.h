// Tetrahedra by CGAL's Delaunay refinement (Mesh_3).
#pragma once

#include "common/mesh.h"

namespace vivify::meshing {

// Meshes the inside of a closed surface with tetrahedra of edge length about `size` (metres) and perturbs and
// exudes slivers. The boundary only approximates the surface, and thin or small parts can be lost: compare
// the volume and the number of parts. Can crash, hang or throw on a surface that is not closed: call it
// through run_guarded.
TetMesh mesh_with_cgal(const TriangleMesh& closed_surface, double size);

}  // namespace vivify::meshing
