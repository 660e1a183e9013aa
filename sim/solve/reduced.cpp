// Reduced-space method: x is the exact forward step of q at every trial, so the objective is a function of q
// alone and falls in every iteration. The most predictable method, and the fallback of the SQP.
#include <algorithm>
#include <cmath>

#include "sim/solve/step_method.h"

namespace vivify::sim {
namespace {

constexpr double kArmijo = 1e-4;
constexpr double kTrialTolerance = 1e-7;

}  // namespace

StepSolution solve_reduced(const StepProblem& problem, const Eigen::VectorXd& q, const Eigen::VectorXd& x,
                           StepWorkspace& workspace) {
  const SolverSettings& settings = problem.solver();
  bool feasible_start = false;
  StepSolution solution = start_feasibly(problem, q, x, kTrialTolerance, workspace, &feasible_start);
  double objective = problem.objective(solution.at.x, solution.rest);

  const double unit = problem.energy_unit();
  double mu = 0;
  int small_gains = 0;
  bool factorized = false;  // the workspace holds D of the solution
  while (feasible_start && solution.iterations < settings.max_iterations && !workspace.expired()) {
    Eigen::VectorXd dq, dx, gradient;
    bool accepted = false;
    const double before = objective;
    // The linearisation lives in the workspace, which trials overwrite: take all that they need from it
    // first.
    std::vector<Eigen::VectorXd> steps_q, steps_x;
    {
      const BlockSolver block(problem, solution.at, solution.rest, settings.exact_hessian, workspace);
      if (!block.definite()) break;
      if (block.decrement() <= settings.decrement * unit) {
        solution.optimal = factorized = true;
        break;
      }
      gradient = block.reduced_gradient();
      double damping = mu;
      for (int k = 0; k <= kMaxDampings; ++k, damping = raise_damping(damping)) {
        steps_q.push_back(limit_change(problem, block.step_q(damping)));
        steps_x.push_back(block.step_x(steps_q.back()));
      }
    }
    ++solution.iterations;

    const auto try_step = [&](const Eigen::VectorXd& step_q, const Eigen::VectorXd& step_x) {
      RestPoint rest = problem.rest_point(solution.rest.q + step_q, false);
      if (rest.smallest_element < kSmallestRest) {
        ++solution.guards;
        return false;
      }
      ForwardResult trial = forward_step(problem, rest, solution.at.x + step_x, kTrialTolerance, workspace);
      solution.forward_iterations += trial.iterations;
      if (!trial.converged) return false;
      if (problem.smallest_element(trial.at) < kSmallestDeformed) {
        ++solution.guards;
        return false;
      }
      const double value = problem.objective(trial.at.x, rest);
      if (!(value <= objective + kArmijo * std::min(0.0, gradient.dot(step_q)))) return false;
      solution.at = std::move(trial.at);
      solution.rest = std::move(rest);
      objective = value;
      return true;
    };

    for (int k = 0; k <= kMaxDampings && !accepted; ++k) {
      accepted = try_step(steps_q[k], steps_x[k]);
      if (accepted) {
        if (k == 0) mu = lower_damping(mu);
      } else {
        ++solution.halvings;
        mu = raise_damping(mu);
      }
    }
    dq = steps_q.back();
    dx = steps_x.back();
    for (int halving = 0; halving < kMaxStepHalvings && !accepted; ++halving) {
      dq *= 0.5;
      dx *= 0.5;
      ++solution.halvings;
      accepted = try_step(dq, dx);
    }
    if (!accepted) break;
    solution.rest = problem.rest_point(solution.rest.q, true);
    small_gains = before - objective < settings.small_gain * std::abs(before) ? small_gains + 1 : 0;
    if (small_gains == 2) {
      solution.optimal = true;
      break;
    }
  }
  finish_exactly(problem, solution, workspace, factorized);
  return solution;
}

}  // namespace vivify::sim
