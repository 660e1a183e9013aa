// Implicit Euler for a fixed rest shape: solves c(x, q) = 0 by minimising the incremental potential with
// Newton's method. It is the passive simulator, and the start and finish of every controlled step.
#pragma once

#include <limits>

#include "sim/solve/linear_solver.h"
#include "sim/solve/processor_time.h"
#include "sim/solve/step_problem.h"

namespace vivify::sim {

struct ForwardResult {
  DeformedPoint at;
  int iterations = 0;
  double residual = 0;  // ‖c‖∞ over the weight of the body
  bool converged = false;
};

// What the solvers of one body share: the stiffness matrix and its factorisation, and the time they have.
struct StepWorkspace {
  explicit StepWorkspace(const SymmetricPattern& pattern) : D(pattern), block(pattern), solver(pattern) {}
  SymmetricMatrix D;
  SymmetricMatrix block;
  LinearSolver solver;
  // A step that takes longer is given up; the solvers look at the clock once per iteration.
  double deadline = std::numeric_limits<double>::infinity();  // s of processor_seconds()
  bool expired() const { return processor_seconds() > deadline; }
};

// From `x`, until ‖c‖∞ ≤ tolerance · weight. `factorized`: the workspace holds the factorisation of D at (x,
// rest).
ForwardResult forward_step(const StepProblem& problem, const RestPoint& rest, const Eigen::VectorXd& x,
                           double tolerance, StepWorkspace& workspace, bool factorized = false);

inline constexpr double kStartTolerance = 1e-4;    // a feasible start need not be exact
inline constexpr double kFinishTolerance = 1e-11;  // every step that is kept is exact physics

}  // namespace vivify::sim
