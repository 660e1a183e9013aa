// Triangle meshes of outlines for 2-D solids.
#pragma once

#include "common/mesh.h"
#include "meshing/outline.h"

namespace vivify::meshing {

struct PlanarMesh {
  Points2 V;              // every vertex is used; sorted by coordinates
  Triangles F;            // counter-clockwise
  double min_angle = 0;   // degrees
  double area_ratio = 0;  // area of the mesh over that of the outline
};

// Triangles of good shape whose number of vertices is within 15 % of the wanted one (20 to 20000). Every
// corner of the outline (a turn by more than 30 degrees) is a vertex; elsewhere the boundary follows the
// outline as closely as the size of the triangles allows. Angles are at least 20 degrees where the corners
// and the number of vertices allow that. Throws Error(geometry) when the outline needs more vertices.
PlanarMesh triangulate_outline(const Outline& outline, int vertices);

// Smallest angle of the triangles (degrees).
double min_angle(const Points2& V, const Triangles& F);

// Moves the vertices that no boundary edge uses and exchanges edges so that the smallest angle round each
// place grows or stays.
void improve_triangles(Points2& V, Triangles& F, int passes = 10);

}  // namespace vivify::meshing
