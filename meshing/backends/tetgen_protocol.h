// What run_tetgen and the vivify_tetgen worker agree on.
// Request: memory limit (MB), switches, points, facets. Answer: points, tetrahedra, boundary triangles, their
// markers.
#pragma once

namespace vivify::meshing {

// The worker ends with this plus the code that TetGen threw (1, 2, 3, 4, 5 or 10).
inline constexpr int kTetgenExit = 40;

}  // namespace vivify::meshing
