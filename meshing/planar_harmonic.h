// Harmonic coordinates of points in a polygon (Joshi et al. 2007, in the plane).
#pragma once

#include "meshing/harmonic.h"

namespace vivify::meshing {

// Weights (#points by #cage vertices), each in [0, 1], rows sum to 1 and reproduce the points: weights * cage
// = points (both to 1e-10). The Laplace equation is solved on a triangle mesh of the cage whose nodes include
// the points, with piecewise-linear values on the cage edges and small triangles round reflex vertices.
// `cage` must be simple and counter-clockwise (validate_planar_cage). Throws Error(geometry) when points are
// not strictly inside it.
Eigen::MatrixXd harmonic_coordinates(const Points2& cage, const Points2& points,
                                     const HarmonicSettings& settings = {}, HarmonicReport* report = nullptr);

}  // namespace vivify::meshing
