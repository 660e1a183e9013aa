// Edge collapse of a surface around other triangles.
#pragma once

#include "common/mesh.h"

namespace vivify::meshing {

// Collapses edges of `surface` (closed, manifold, outward, free of self-intersections, around `enclosed`) in
// the order of their quadric error (Garland and Heckbert 1997) until `vertices` vertices are left or no
// collapse is legal. A collapse is legal when it keeps the topology, flips no triangle, and no new triangle
// touches `enclosed` or another triangle of the surface; so the result still goes around `enclosed`. Where
// the best point of an edge is not legal, the one that adds least volume outside the planes around the edge
// is tried (Sander et al. 2000, progressive hulls). At the end single vertices are moved inward as far as
// that is legal, which makes the surface smaller at the same count.
TriangleMesh collapse_around(const TriangleMesh& surface, const TriangleMesh& enclosed, int vertices);

}  // namespace vivify::meshing
