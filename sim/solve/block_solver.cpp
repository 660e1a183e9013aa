#include "sim/solve/block_solver.h"

#include <Eigen/Dense>

namespace vivify::sim {

BlockSolver::BlockSolver(const StepProblem& problem, const DeformedPoint& at, const RestPoint& rest,
                         Eigen::VectorXd c, bool exact_hessian, StepWorkspace& workspace)
    : problem_(problem), at_(at), rest_(rest), workspace_(workspace), c_(std::move(c)) {
  problem.stiffness(at, rest, workspace.D);
  definite_ = workspace.solver.factorize(workspace.D);
  if (!definite_) return;

  const Eigen::MatrixXd& G = problem.goals().G;
  goal_residual_ = problem.goals().residual(at.x);
  regularizer_gradient_ = problem.regularizer_gradient(rest);

  Eigen::MatrixXd rhs(c_.size(), G.rows() + 1);
  rhs << G.transpose(), c_;
  const Eigen::MatrixXd solved = workspace.solver.solve(rhs);
  d_ = solved.rightCols<1>();
  lambda_ = -solved.leftCols(G.rows()) * goal_residual_;
  const Eigen::MatrixXd Z = problem.multiply_Et(at, rest, solved.leftCols(G.rows()));
  reduced_gradient_ = regularizer_gradient_ - Z * goal_residual_;
  rhs_ = reduced_gradient_ + Z * (G * d_);
  if (!exact_hessian) {
    K_ = problem.regularizer_gauss_newton(rest) + Z * Z.transpose();
    cholesky_.compute(K_);
    return;
  }
  const Eigen::Index parameters = rest.q.size();
  const Eigen::MatrixXd E = problem.multiply_E(at, rest, Eigen::MatrixXd::Identity(parameters, parameters));
  const Eigen::MatrixXd F = workspace.solver.solve(E);
  problem.block_A(at, rest, lambda_, workspace.block);
  const Eigen::MatrixXd B = problem.block_B(at, rest, lambda_);
  const Eigen::MatrixXd BF = B * F;
  K_ = problem.block_C(at, rest, lambda_) - BF - BF.transpose() + F.transpose() * (workspace.block * F) +
       Z * Z.transpose();
  cholesky_.compute(K_);
  rhs_ += F.transpose() * (workspace.block * d_) - B * d_;
}

Eigen::VectorXd BlockSolver::solve_K(double mu, const Eigen::VectorXd& rhs) const {
  if (mu == 0 && cholesky_.info() == Eigen::Success) return cholesky_.solve(rhs);
  Eigen::MatrixXd damped = K_;
  damped.diagonal() += mu * K_.diagonal().cwiseAbs();
  const Eigen::LLT<Eigen::MatrixXd> cholesky(damped);
  if (cholesky.info() == Eigen::Success) return cholesky.solve(rhs);
  // Only the exact Hessian can be indefinite: reflect the negative curvature, which keeps the step a descent
  // step.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(damped);
  const double floor = 1e-10 * eigen.eigenvalues().cwiseAbs().maxCoeff() + 1e-300;
  const Eigen::VectorXd curvature = eigen.eigenvalues().cwiseAbs().cwiseMax(floor);
  return eigen.eigenvectors() * curvature.cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose() *
         rhs;
}

double BlockSolver::decrement() const { return 0.5 * reduced_gradient_.dot(solve_K(0, reduced_gradient_)); }

Eigen::VectorXd BlockSolver::step_q(double mu) const { return -solve_K(mu, rhs_); }

Eigen::VectorXd BlockSolver::step_x(const Eigen::VectorXd& dq) const {
  return -workspace_.solver.solve(c_ + problem_.multiply_E(at_, rest_, dq));
}

double BlockSolver::slope(const Eigen::VectorXd& dx, const Eigen::VectorXd& dq) const {
  return goal_residual_.dot(problem_.goals().G * dx) + regularizer_gradient_.dot(dq);
}

}  // namespace vivify::sim
