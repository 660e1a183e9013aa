// Tetrahedra by TetGen 1.5, which runs in a process of its own (vivify_tetgen): it crashes on input that it
// rejects, and its licence (AGPL) stays out of the rest of the program.
#pragma once

#include <Eigen/Core>
#include <string>

#include "common/mesh.h"
#include "meshing/guarded_process.h"

namespace vivify::meshing {

struct TetgenInput {
  Points points;     // #V by 3; points of no facet become nodes inside
  Triangles facets;  // #F by 3, a closed surface without self-intersections, in any orientation
};

struct TetgenOutput {
  TetMesh mesh;                    // the first rows of V are the input points, bit by bit; all T are positive
  Triangles boundary;              // #B by 3, outward
  Eigen::VectorXi boundary_facet;  // #B, the input facet that each boundary triangle lies on
};

// Runs TetGen with `switches` such as "pYq1.414". The input is scaled to a bounding box with diagonal 1
// before, so that volumes in the switches ("a1e-5") are parts of the cubed diagonal. Points that no
// tetrahedron uses are kept. Throws Error(geometry) when TetGen rejects the surface, crashes, exceeds a limit
// or makes no tetrahedron.
TetgenOutput run_tetgen(const TetgenInput& input, const std::string& switches,
                        const ProcessLimits& limits = {});

}  // namespace vivify::meshing
