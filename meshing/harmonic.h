// Harmonic coordinates of points in a cage (Joshi et al. 2007): weights that move the points with the cage.
#pragma once

#include <Eigen/Core>

#include "common/mesh.h"
#include "meshing/cage_weights.h"

namespace vivify::meshing {

struct HarmonicSettings {
  // Wanted size of the Laplace problem. Measured in a U-shaped cage: rms error 3e-3 with 2 000 unknowns, 4e-4
  // with 15 000, 2e-4 with 30 000.
  int unknowns = 15000;
  // Two cage faces that make a flat convex quadrilateral take the mean of the boundary values for both of its
  // diagonals: the weights keep the symmetry of a box, where one diagonal per side makes them up to three
  // times as large at half of the corners.
  bool both_diagonals = true;
};

// Weights (#points by #cage vertices), each in [0, 1], rows sum to 1 and reproduce the points: weights *
// cage.V = points (both to 1e-10). The Laplace equation is solved on a tetrahedral mesh of the cage whose
// nodes include the points, with a refined boundary and piecewise-linear values on the cage faces. The
// discrete solution may be slightly negative; such rows are moved to the nearest weights that are not. `cage`
// must be closed, outward and free of self-intersections (validate_cage). Throws Error(geometry) when points
// are not strictly inside it.
Eigen::MatrixXd harmonic_coordinates(const TriangleMesh& cage, const Points& points,
                                     const HarmonicSettings& settings = {}, HarmonicReport* report = nullptr);

}  // namespace vivify::meshing
