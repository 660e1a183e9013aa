// Better shaped tetrahedra by moving vertices and exchanging edges (after Freitag and Ollivier-Gooch 1997,
// and Klingner and Shewchuk 2008).
#pragma once

#include "common/mesh.h"
#include "meshing/closest_point.h"

namespace vivify::meshing {

struct ImproveSettings {
  double wanted_angle =
      18;  // degrees: tetrahedra whose dihedral angles all lie within [a, 180 − a] are left alone
  double surface_tolerance = 0;  // metres: how far exchanging edges may move the boundary
  int passes = 20;
  bool keep_floor = false;  // vertices at the smallest height stay at that height
};

// Raises the smallest sine of a dihedral angle, step by step; no step makes the worst tetrahedron of its
// place worse. Boundary vertices slide along flat and smoothly curved places and along creases, and stay on
// `surface` if they are on it (within the tolerance), others near their place; the corners of the boundary
// stay where they are. The vertices keep their number.
void improve_tetrahedra(TetMesh& mesh, const ClosestPoint& surface, const ImproveSettings& settings);

}  // namespace vivify::meshing
