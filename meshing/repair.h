// Any triangles to a surface that encloses a volume.
#pragma once

#include <string>
#include <vector>

#include "common/mesh.h"
#include "meshing/guarded_process.h"

namespace vivify::meshing {

struct RepairedSurface {
  TriangleMesh
      mesh;  // closed, manifold, outward, free of self-intersections, of positive volume; V and F only
  std::string route;               // kept (unchanged but for joined vertices) | repaired | wrapped
  std::vector<std::string> notes;  // what was done, in plain words with counts
};

// Leaves out small decoration (meshing/main_body.h), joins duplicate vertices, drops degenerate and duplicate triangles, orients and stitches, and fills holes;
// where the result still is open or intersects itself, wraps it. Runs in a child process with `limits`.
// Throws Error(geometry) when the input has no triangle of positive area or a vertex that is not finite.
RepairedSurface repair_surface(const TriangleMesh& input, const ProcessLimits& limits = {120, 6000});

}  // namespace vivify::meshing
