#include "sim/solve/step_method.h"

#include <algorithm>
#include <array>

namespace vivify::sim {
namespace {

constexpr std::array<StepMethodEntry, 2> kMethods = {{
    {"sqp", solve_sqp},
    {"reduced", solve_reduced},
}};

}  // namespace

std::span<const StepMethodEntry> step_methods() { return kMethods; }

double raise_damping(double mu) { return std::max(1e-2, 6 * mu); }
double lower_damping(double mu) { return mu < 1e-6 ? 0 : mu / 5; }

Eigen::VectorXd limit_change(const StepProblem& problem, Eigen::VectorXd dq) {
  const double largest = problem.relative_change(dq);
  if (largest > kLargestChange) dq *= kLargestChange / largest;
  return dq;
}

StepSolution start_feasibly(const StepProblem& problem, const Eigen::VectorXd& q, const Eigen::VectorXd& x,
                            double tolerance, StepWorkspace& workspace, bool* converged) {
  StepSolution solution;
  solution.rest = problem.rest_point(q, true);
  ForwardResult start = forward_step(problem, solution.rest, x, tolerance, workspace);
  solution.forward_iterations = start.iterations;
  solution.at = std::move(start.at);
  if (converged != nullptr) *converged = start.converged;
  return solution;
}

void finish_exactly(const StepProblem& problem, StepSolution& solution, StepWorkspace& workspace,
                    bool factorized) {
  const ForwardResult finish =
      forward_step(problem, solution.rest, solution.at.x, kFinishTolerance, workspace, factorized);
  solution.at = finish.at;
  solution.exact = finish.converged;
  solution.residual = finish.residual;
  solution.forward_iterations += finish.iterations;
  solution.objective = problem.objective(solution.at.x, solution.rest);
}

}  // namespace vivify::sim
