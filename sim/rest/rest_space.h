// Rest-shape parameterisation, equation (4) of Coros et al. 2012: X(p) = X₀ + L p. A rest space is a linear
// map from p to the stacked rest stencils; compatible spaces (cage) and incompatible ones (examples) are the
// same code.
#pragma once

#include <Eigen/Core>
#include <string>

#include "sim/elastic/models.h"

namespace vivify::sim {

struct RestSpace {
  std::string type;
  RestLayout layout = RestLayout::compatible;
  Eigen::VectorXd X0;  // 3 #rest points, metres
  Eigen::MatrixXd L;   // 3 #rest points by #p
  // Orthonormal basis of the parameters that change the shape (#p by #q): rigid motions of the rest shape are
  // null directions of the control problem (they change no measure), so p moves in the span of `basis` only,
  // p = basis q.
  Eigen::MatrixXd basis;
  Eigen::MatrixXd Lq;  // L · basis

  int parameters() const { return static_cast<int>(L.cols()); }
  int free_parameters() const { return static_cast<int>(basis.cols()); }
  Eigen::VectorXd shape(const Eigen::VectorXd& q) const { return X0 + Lq * q; }
};

// Cage space: p are the displacements of the cage vertices (x, y, z of the first, then of the next), and the
// rest vertices follow with their harmonic coordinates (Section 4). `rest` is #V by 3, `weights` #V by #C.
RestSpace make_cage_space(const Points& rest, const Eigen::MatrixXd& weights);

// The orthonormal complement of the parameters whose L p is a rigid motion of X₀ (translation or linearised
// rotation).
Eigen::MatrixXd shape_changing_basis(const Eigen::VectorXd& X0, const Eigen::MatrixXd& L);

}  // namespace vivify::sim
