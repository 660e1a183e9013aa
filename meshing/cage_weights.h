// Exact generalized barycentric coordinates from nearly exact ones, in the plane and in space.
#pragma once

#include <Eigen/Core>

#include "common/mesh.h"

namespace vivify::meshing {

struct HarmonicReport {
  Eigen::Index unknowns = 0;   // of the Laplace problem that was solved
  Eigen::Index elements = 0;   // its triangles or tetrahedra
  double most_negative = 0;    // smallest weight before the projection
  Eigen::Index projected = 0;  // points whose weights were projected
  double sum_error = 0;        // largest |sum of weights - 1| afterwards
  double position_error = 0;   // largest |C^T w - x| afterwards, over the cage's diagonal
};

// The weights nearest to `weights` (least squares) with w >= 0, sum w = 1 and C^T w = x for the cage
// vertices C (#C by d). Throws Error(numerical) when x lies outside the convex hull of C.
Eigen::VectorXd project_weights(const Eigen::VectorXd& weights, const Points& C, const Eigen::Vector3d& x);
Eigen::VectorXd project_weights(const Eigen::VectorXd& weights, const Points2& C, const Eigen::Vector2d& x);

// Projects the rows of `weights` (#P by #C) that have an entry outside [0, 1], and checks that the weights
// reproduce the points. Fills in all of the report but the size of the problem. Throws Error(numerical).
void make_exact(Eigen::MatrixXd& weights, const Points& C, const Points& points, HarmonicReport& report);
void make_exact(Eigen::MatrixXd& weights, const Points2& C, const Points2& points, HarmonicReport& report);

}  // namespace vivify::meshing
