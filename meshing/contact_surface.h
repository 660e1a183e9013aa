// The surface with which a body touches other bodies: a coarse copy of the drawn one that follows the
// simulation mesh.
#pragma once

#include "common/mesh.h"
#include "meshing/embedding.h"
#include "meshing/outline.h"
#include "meshing/process_limits.h"

namespace vivify::meshing {

struct CoarseSurface {
  RowMatrixXd V;         // #P by 3, in the plane by 2; at rest
  RowMatrixXi F;         // #F by 3, outward; in the plane the edges, #P by 2, with the inside on their left
  Embedding embedding;   // #P, in the elements of the simulation mesh
  double deviation = 0;  // m: the farthest that a vertex of either surface, or the middle of a coarse face or
                         // edge, is from the other surface
};

// About `points` vertices of the closed surface by collapsing edges (meshing/coarsen.h); more where the
// result would intersect itself, all of them when nothing less will do. Runs in a child process with
// `limits`. Throws Error(geometry) like embed().
CoarseSurface coarse_contact_surface(const TriangleMesh& closed, const TetMesh& mesh, int points,
                                     const ProcessLimits& limits = {120, 6000});

// About `points` points along the outline, its corners (meshing/polyline.h) among them, in the triangles F of
// the points V; the outline as it is where its loops would meet.
CoarseSurface coarse_contact_outline(const Outline& outline, const Points2& V, const Triangles& F,
                                     int points);

}  // namespace vivify::meshing
