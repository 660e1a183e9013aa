#include "sim/solve/forward_step.h"

namespace vivify::sim {
namespace {

constexpr int kMaxIterations = 60;
constexpr int kMaxHalvings = 30;
constexpr double kArmijo = 1e-4;
// Forces far above the weight round to more than the tolerance. A state is as good as it can be when a step
// moves it by no more than this share of the height without halving the residual.
constexpr double kRoundedStep = 1e-10;
constexpr double kRoundedResidual = 1e-8;

}  // namespace

ForwardResult forward_step(const StepProblem& problem, const RestPoint& rest, const Eigen::VectorXd& x,
                           double tolerance, StepWorkspace& workspace, bool factorized) {
  ForwardResult result;
  result.at = problem.deformed_point(x);
  Eigen::VectorXd c = problem.residual(result.at, rest);
  double potential = problem.potential(result.at, rest);
  for (;; ++result.iterations) {
    result.residual = problem.relative_force(c);
    // A maximum may pass over what is not a number.
    const bool finite = std::isfinite(potential) && c.allFinite();
    result.converged = finite && result.residual <= tolerance;
    if (result.converged || !finite || result.iterations == kMaxIterations || workspace.expired())
      return result;

    if (!factorized) {
      problem.stiffness(result.at, rest, workspace.D);
      for (double shift = 1; !workspace.solver.factorize(workspace.D); shift *= 4) {
        if (shift > 1e12) return result;
        problem.add_inertia(shift,
                            workspace.D);  // only the direction changes, not the equation that is solved
      }
    }
    factorized = false;
    const Eigen::VectorXd step = -workspace.solver.solve(c);
    const double slope = c.dot(step), before = c.norm();
    const bool rounded = result.residual <= kRoundedResidual &&
                         problem.relative_length(step) <= kRoundedStep;
    bool accepted = false;
    double alpha = 1;
    for (int halving = 0; halving < kMaxHalvings && !accepted; ++halving, alpha *= 0.5) {
      DeformedPoint trial = problem.deformed_point(result.at.x + alpha * step);
      const double trial_potential = problem.potential(trial, rest);
      Eigen::VectorXd trial_c = problem.residual(trial, rest);
      // Near the solution the potential is flat to rounding; there the residual itself must shrink.
      accepted = trial_potential <= potential + kArmijo * alpha * slope || trial_c.norm() <= 0.5 * before;
      if (accepted) {
        result.at = std::move(trial);
        potential = trial_potential;
        c = std::move(trial_c);
      }
    }
    if (rounded && (!accepted || c.norm() > 0.5 * before)) {
      result.residual = problem.relative_force(c);
      result.converged = result.residual <= kRoundedResidual;
      if (result.converged) return result;
    }
    if (!accepted) return result;
  }
}

}  // namespace vivify::sim
