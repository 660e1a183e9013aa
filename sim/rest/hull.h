// The hull of the examples, Section 5.1 of Coros et al. 2012: weights of the examples of a group are kept at
// Σ p ≤ 1 and p ≥ 0 by one-sided quadratic penalties, r = ½ w (Σ max(0, Σ p − 1)² + Σ max(0, −p)²). The
// printed ½ (Σ p − 1)² would forbid the rest pose, whose own weight is 1 − Σ p.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace vivify::sim {

struct Hull {
  std::vector<std::vector<int>> groups;  // parameters of each
  double weight = 0;                     // w, J

  double energy(const Eigen::VectorXd& p) const;
  void add_gradient(const Eigen::VectorXd& p, Eigen::VectorXd& gradient) const;
  void add_hessian(const Eigen::VectorXd& p, Eigen::MatrixXd& hessian) const;
};

}  // namespace vivify::sim
