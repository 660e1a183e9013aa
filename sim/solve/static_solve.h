// Equilibrium of a body without motion: the shape of least elastic energy for given rest measures, under
// constant forces, with some vertices held. It makes example poses, and shows incompatible rest shapes
// (Section 5.3 of Coros et al. 2012).
#pragma once

#include <vector>

#include "sim/elastic/models.h"
#include "sim/solve/linear_solver.h"

namespace vivify::sim {

struct StaticProblem {
  const ElasticFamilies& families;  // bound to `pattern`
  const SymmetricPattern& pattern;
  const std::vector<Eigen::VectorXd>& S;  // per family: measures of the rest shape
  Eigen::VectorXd force;                  // d #V, N
  std::vector<bool> held;                 // #V: vertices that stay where they are
};

struct StaticSolution {
  Eigen::VectorXd x;
  int iterations = 0;
  double energy = 0;    // J
  double residual = 0;  // largest force on a vertex that is not held, N
  bool converged = false;
};

// From x, by Newton's method with the stiffness shifted to definite where needed, until no force on a free
// vertex exceeds `tolerance` (N). A body that is not held keeps the rigid motion it starts with.
StaticSolution solve_static(const StaticProblem& problem, Eigen::VectorXd x, double tolerance);

}  // namespace vivify::sim
