// Lagrangian optimisation, Section 6 of Coros et al. 2012, with what makes it converge when contacts switch:
// a feasible start, an L1 merit function with γ above the multipliers, second-order correction, and
// Levenberg–Marquardt damping of K before any shortening of the step (a refused step is turned, not cut).
#include <algorithm>
#include <cmath>

#include "sim/solve/step_method.h"

namespace vivify::sim {
namespace {

constexpr double kArmijo = 1e-4;
constexpr double kMeritMargin = 1.2;

}  // namespace

StepSolution solve_sqp(const StepProblem& problem, const Eigen::VectorXd& q, const Eigen::VectorXd& x,
                       StepWorkspace& workspace) {
  const SolverSettings& settings = problem.solver();
  StepSolution solution = start_feasibly(problem, q, x, kStartTolerance, workspace);

  const double unit = problem.energy_unit();
  const auto feasible = [&](const Eigen::VectorXd& c) {
    return problem.relative_force(c) <= 10 * kStartTolerance;
  };
  const auto restore = [&] {
    ForwardResult forward = forward_step(problem, solution.rest, solution.at.x, kStartTolerance, workspace);
    solution.forward_iterations += forward.iterations;
    solution.at = std::move(forward.at);
    return forward.converged;
  };
  double mu = 0, gamma = 0;
  int small_gains = 0;
  bool factorized = false;   // the workspace holds D of the solution
  Eigen::VectorXd residual;  // of the solution; empty when it is not known
  while (solution.iterations < settings.max_iterations && !workspace.expired()) {
    if (residual.size() == 0) residual = problem.residual(solution.at, solution.rest);
    const BlockSolver block(problem, solution.at, solution.rest, std::move(residual), settings.exact_hessian,
                            workspace);
    residual.resize(0);
    const bool is_feasible = feasible(block.residual());
    if (!block.definite()) {
      if (is_feasible || !restore()) break;
      continue;
    }
    if (block.decrement() <= settings.decrement * unit) {
      solution.optimal = factorized = is_feasible;
      if (is_feasible || !restore()) break;
      continue;  // only the equations of motion are left to be solved
    }
    ++solution.iterations;

    gamma = std::max(gamma, kMeritMargin * block.lambda().lpNorm<Eigen::Infinity>());
    const double objective = problem.objective(solution.at.x, solution.rest);
    const double infeasibility = block.residual().lpNorm<1>();
    const double merit = objective + gamma * infeasibility;

    // Accepts (x + dx, q + dq) when no element collapses and the merit function falls enough; c is the
    // residual there, left empty when it was not evaluated.
    const auto try_step = [&](const Eigen::VectorXd& dx, const Eigen::VectorXd& dq, double wanted,
                              Eigen::VectorXd* c) {
      c->resize(0);
      RestPoint rest = problem.rest_point(solution.rest.q + dq, false);
      DeformedPoint at = problem.deformed_point(solution.at.x + dx);
      if (rest.smallest_element < kSmallestRest || problem.smallest_element(at) < kSmallestDeformed) {
        ++solution.guards;
        return false;
      }
      *c = problem.residual(at, rest);
      if (!(problem.objective(at.x, rest) + gamma * c->lpNorm<1>() <= merit + wanted)) return false;
      solution.at = std::move(at);
      solution.rest = std::move(rest);
      return true;
    };

    bool accepted = false;
    Eigen::VectorXd dq, dx, c;
    const int dampings = is_feasible ? kMaxDampings : 0;
    for (int damping = 0; damping <= dampings && !accepted; ++damping) {
      dq = limit_change(problem, block.step_q(mu));
      dx = block.step_x(dq);
      const double wanted = kArmijo * std::min(0.0, block.slope(dx, dq) - gamma * infeasibility);
      accepted = try_step(dx, dq, wanted, &c);
      if (!accepted && c.size() > 0) accepted = try_step(dx + block.correction(c), dq, wanted, &c);
      if (accepted) {
        if (damping == 0) mu = lower_damping(mu);
      } else {
        ++solution.halvings;
        mu = raise_damping(mu);
      }
    }
    if (!accepted &&
        !is_feasible) {  // Newton's method on c went astray: no step in q can help before that is mended
      if (!restore()) break;
      continue;
    }
    for (int halving = 0; halving < kMaxStepHalvings && !accepted; ++halving) {
      dq *= 0.5;
      dx *= 0.5;
      ++solution.halvings;
      accepted = try_step(dx, dq, kArmijo * std::min(0.0, block.slope(dx, dq)), &c);
    }
    if (!accepted) break;

    solution.rest = problem.rest_point(solution.rest.q, true);
    const double gain = objective - problem.objective(solution.at.x, solution.rest);
    const bool small = std::abs(gain) < settings.small_gain * objective && feasible(c);
    small_gains = small ? small_gains + 1 : 0;
    if (small_gains == 2) {
      solution.optimal = true;
      break;
    }
    residual = std::move(c);
  }
  finish_exactly(problem, solution, workspace, factorized);
  return solution;
}

}  // namespace vivify::sim
