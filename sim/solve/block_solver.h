// Block elimination (13)–(17) of Coros et al. 2012 at one iterate. D is factorised once; with Gauss–Newton
// blocks (A = GᵀG, B = 0, C = Gauss–Newton of r) the reduced matrix is K = R + Z Zᵀ with Z = Eᵀ D⁻¹ Gᵀ, and F
// = D⁻¹E is never formed. The multiplier is recomputed exactly, λ = −D⁻ᵀ Gᵀ(Gx − s), so that a = ∂L/∂x = 0.
#pragma once

#include <Eigen/Cholesky>

#include "sim/solve/forward_step.h"

namespace vivify::sim {

class BlockSolver {
 public:
  // Linearises at (at, rest), where the residual is `c`; `rest` needs derivatives. definite() tells whether D
  // is positive definite; nothing else may be asked when it is not.
  BlockSolver(const StepProblem& problem, const DeformedPoint& at, const RestPoint& rest, Eigen::VectorXd c,
              bool exact_hessian, StepWorkspace& workspace);
  BlockSolver(const StepProblem& problem, const DeformedPoint& at, const RestPoint& rest, bool exact_hessian,
              StepWorkspace& workspace)
      : BlockSolver(problem, at, rest, problem.residual(at, rest), exact_hessian, workspace) {}

  bool definite() const { return definite_; }
  const Eigen::VectorXd& residual() const { return c_; }
  const Eigen::VectorXd& lambda() const { return lambda_; }
  const Eigen::MatrixXd& K() const { return K_; }
  // Gradient of the objective along the constraint, ∇r + Eᵀλ.
  const Eigen::VectorXd& reduced_gradient() const { return reduced_gradient_; }
  // Newton decrement ½ gᵀ K⁻¹ g of the reduced gradient, J.
  double decrement() const;

  // Steps δq = −(K + μ diag K)⁻¹ (∇r + Eᵀλ − B d + Fᵀ A d) and δx = −D⁻¹ (c + E δq), to be added.
  Eigen::VectorXd step_q(double mu) const;
  Eigen::VectorXd step_x(const Eigen::VectorXd& dq) const;
  // −D⁻¹ c for another residual: the second-order correction.
  Eigen::VectorXd correction(const Eigen::VectorXd& c) const { return -workspace_.solver.solve(c); }
  // Change of ½|Gx − s|² + r to first order along (δx, δq).
  double slope(const Eigen::VectorXd& dx, const Eigen::VectorXd& dq) const;

 private:
  Eigen::VectorXd solve_K(double mu, const Eigen::VectorXd& rhs) const;

  const StepProblem& problem_;
  const DeformedPoint& at_;
  const RestPoint& rest_;
  StepWorkspace& workspace_;
  bool definite_ = false;
  Eigen::VectorXd c_, d_, lambda_, goal_residual_, regularizer_gradient_, reduced_gradient_, rhs_;
  Eigen::MatrixXd K_;
  Eigen::LLT<Eigen::MatrixXd> cholesky_;  // of K
};

}  // namespace vivify::sim
