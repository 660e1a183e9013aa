// A coarse tetrahedral mesh for simulation around a detailed surface.
#pragma once

#include <string>
#include <vector>

#include "common/mesh.h"
#include "common/schema.h"
#include "common/value.h"
#include "meshing/guarded_process.h"

namespace vivify::meshing {

struct TetrahedralizeSettings {
  std::string backend = "tetgen";  // tetgen | cgal
  int vertices = 100;              // wanted; reached within 15 %
  double gap = 0;  // part of the size below which gaps and holes are closed; 0: from `vertices`
  ProcessLimits limits = {60, 6000};
};

struct TetrahedralizeResult {
  TetMesh mesh;                    // every vertex is used; sorted by coordinates
  std::vector<std::string> notes;  // in plain words
  double min_dihedral = 0;         // degrees
  double max_dihedral = 0;         // degrees
  double volume_ratio = 0;         // volume of the mesh over that of the drawn surface
  double distance = 0;             // largest distance of a vertex of the drawn surface from the boundary (m)
  int components = 0;              // parts of the mesh
};

// Wraps `closed_surface` so that what the vertices cannot resolve is closed, coarsens it, fits it back onto
// the surface, fills it with tetrahedra and improves their shape. The number of vertices is within 15 % of
// the wanted one, the boundary is a closed manifold, and every tetrahedron is positive. Throws
// Error(geometry) when the surface is not closed or no attempt passes these checks.
TetrahedralizeResult tetrahedralize(const TriangleMesh& closed_surface,
                                    const TetrahedralizeSettings& settings);

// The key `tetrahedra` of a body.
Schema tetrahedra_schema();
TetrahedralizeSettings tetrahedra_settings(const Value& value);

}  // namespace vivify::meshing
