// Problem (5) of one step, solved by Ipopt with its exact derivatives: the reference of the step methods, for
// tests and benchmarks only.
#pragma once

#include <limits>
#include <memory>
#include <string>

#include "sim/solve/step_problem.h"

namespace vivify::ipopt {

struct Settings {
  double tolerance = 1e-10;  // of the scaled optimality conditions
  int max_iterations = 500;
  // Ends at the first iterate that is as good: |c|∞ over the weight and objective (J) not above these.
  double enough_residual = 0;
  double enough_objective = -std::numeric_limits<double>::infinity();
};

struct Solution {
  Eigen::VectorXd x, q, lambda;
  double objective = 0;  // J
  double residual = 0;   // |c|∞ over the weight
  int iterations = 0;
  bool converged = false;         // to the tolerance, or as good as was enough
  std::string status;             // Ipopt's own name of how it ended
  double evaluation_seconds = 0;  // processor time spent in the functions of the problem
};

// The variables are x and q in units of the body's height and of the rest space, and the goals' residuals z =
// G x − s, so that the Hessian keeps the sparsity of D; the constraints are c(x, q) = 0 over the weight and
// the definition of z.
class Solver {
 public:
  // `problem` must outlive it.
  explicit Solver(const sim::StepProblem& problem);
  ~Solver();
  Solver(const Solver&) = delete;

  // From (x, q). Later calls use the symbolic analysis of the first.
  Solution solve(const Eigen::VectorXd& x, const Eigen::VectorXd& q, const Settings& settings = {});

 private:
  struct Application;
  std::unique_ptr<Application> application_;
};

// How far (x, q) is from satisfying the optimality conditions (12) with λ.
struct KktError {
  double constraint = 0;  // |c|∞ over the weight
  double x = 0;           // |Gᵀ(G x − s) + D λ|∞ · height over weight · height
  double q = 0;           // |∇r + Eᵀ λ|∞ · unit over weight · height
};
KktError kkt_error(const sim::StepProblem& problem, const Eigen::VectorXd& x, const Eigen::VectorXd& q,
                   const Eigen::VectorXd& lambda);

}  // namespace vivify::ipopt
