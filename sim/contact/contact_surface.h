// The surface with which a body touches other bodies and itself.
#pragma once

#include "common/mesh.h"
#include "sim/contact/contact_set.h"

namespace vivify::sim {

struct ContactSurface {
  ContactPoints points;    // #P, embedded in the simulation mesh
  RowMatrixXi edges;       // #E by 2, of points; in the plane counter-clockwise about solids
  RowMatrixXi faces;       // #F by 3, of points, outward; empty for bodies of the plane
  Points rest;             // #P by 3, the points at rest, m
  double radius = 0;       // m: half the thickness of shells and rods; 0 for solids
  bool two_sided = false;  // shells and rods have no inside

  bool planar() const { return points.dimension == 2; }
};

// The boundary of a solid (faces and edges of tetrahedra, edges of triangles of the plane), or the whole of a
// shell or rod of half thickness `radius`: each point is a vertex of the mesh, in the mesh's order. Throws
// Error(geometry) when a shell or rod has no thickness, or the mesh no elements.
ContactSurface boundary_of(const SimMesh& mesh, double radius = 0);

// The edges of triangles, each once with its smaller index first, sorted (#E by 2).
RowMatrixXi edges_of(const RowMatrixXi& faces);

}  // namespace vivify::sim
