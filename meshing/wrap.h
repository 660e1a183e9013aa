// A closed, manifold surface without self-intersections around any triangles (alpha wrapping).
#pragma once

#include "common/mesh.h"

namespace vivify::meshing {

// Wraps the triangles: what a ball of diameter `alpha` cannot enter is closed, the vertices keep the distance
// `offset` from the triangles, and every triangle lies strictly inside. Lengths in metres. A mesh with holes
// wider than alpha becomes a hollow shell: fill holes before. Can take long or much memory for small alpha:
// call it through run_guarded.
TriangleMesh wrap_surface(const TriangleMesh& soup, double alpha, double offset);

}  // namespace vivify::meshing
