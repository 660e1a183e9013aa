// Methods that solve problem (5) for one step, behind one interface.
#pragma once

#include <span>
#include <string_view>

#include "sim/solve/block_solver.h"

namespace vivify::sim {

struct StepSolution {
  DeformedPoint at;  // c(x, q) = 0 to kFinishTolerance when `exact`
  RestPoint rest;
  bool exact = false;    // the equations of motion hold
  bool optimal = false;  // the decrement is below its limit, or no further gain was possible
  int iterations = 0;    // of the optimiser
  int halvings = 0;      // trial steps that were damped or shortened
  int guards = 0;        // trial steps refused because an element collapsed
  int forward_iterations = 0;
  double residual = 0;   // ‖c‖∞ over the weight
  double objective = 0;  // J
};

struct StepMethodEntry {
  std::string_view name;
  // From the parameters q and the guess x.
  StepSolution (*solve)(const StepProblem& problem, const Eigen::VectorXd& q, const Eigen::VectorXd& x,
                        StepWorkspace& workspace);
};

// "sqp": Lagrangian optimisation of Section 6; "reduced": every trial of q is followed by an exact forward
// step.
std::span<const StepMethodEntry> step_methods();

StepSolution solve_sqp(const StepProblem&, const Eigen::VectorXd& q, const Eigen::VectorXd& x,
                       StepWorkspace&);
StepSolution solve_reduced(const StepProblem&, const Eigen::VectorXd& q, const Eigen::VectorXd& x,
                           StepWorkspace&);

// Parts that the methods share.
inline constexpr double kSmallestDeformed =
    0.05;  // trials that squeeze an element below this share of its size fail
inline constexpr double kSmallestRest = 0.2;
inline constexpr double kLargestChange = 0.1;  // of a parameter in one iteration, in units of the rest space
inline constexpr int kMaxDampings = 8;         // raises of the Levenberg–Marquardt parameter before halving
inline constexpr int kMaxStepHalvings = 10;
double raise_damping(double mu);  // after a refused trial
double lower_damping(double mu);  // after a first trial that was accepted
Eigen::VectorXd limit_change(const StepProblem& problem, Eigen::VectorXd dq);
// A feasible start: the forward step of q from x. `converged` is told whether it reached the tolerance.
StepSolution start_feasibly(const StepProblem& problem, const Eigen::VectorXd& q, const Eigen::VectorXd& x,
                            double tolerance, StepWorkspace& workspace, bool* converged = nullptr);
// Ends a solution with an exact forward step from its x. `factorized`: the workspace holds D of the solution.
void finish_exactly(const StepProblem& problem, StepSolution& solution, StepWorkspace& workspace,
                    bool factorized = false);

}  // namespace vivify::sim
