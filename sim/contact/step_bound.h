// How far two surfaces may move along straight lines before they would touch.
#pragma once

#include <Eigen/Core>

#include "sim/contact/surface_pairs.h"

namespace vivify::sim {

// The largest t ≤ 1 up to which no features of the surfaces touch while the vertices move from x to x + t dx:
// no point and face, and no two edges, come nearer than `share` of their distance at the start (within 1 % of
// that distance above it). By additive conservative advancement (Li et al. 2021, "Codimensional incremental
// potential contact") of all features whose motions have boxes within a thousandth of an edge of each other;
// the others cannot touch. What is inside a solid at the start, or touches to 1e-12 m, does not hold the
// motion back: that is for the forces.
double step_bound(const SurfaceState& a, const Eigen::VectorXd& dx_a, const SurfaceState& b,
                  const Eigen::VectorXd& dx_b, double share = 0.1);

// The same of one surface with itself, for features that share no points.
double self_step_bound(const SurfaceState& a, const Eigen::VectorXd& dx, double share = 0.1);

}  // namespace vivify::sim
