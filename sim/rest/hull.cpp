#include "sim/rest/hull.h"

#include <algorithm>

namespace vivify::sim {
namespace {

// Calls visit(members, sign, excess) for every violated condition: excess > 0 grows by sign per member.
template <class Visit>
void each_violation(const std::vector<std::vector<int>>& groups, const Eigen::VectorXd& p,
                    const Visit& visit) {
  for (const std::vector<int>& group : groups) {
    double sum = 0;
    for (const int k : group) {
      sum += p[k];
      if (p[k] < 0) visit(std::vector<int>{k}, -1.0, -p[k]);
    }
    if (sum > 1) visit(group, 1.0, sum - 1);
  }
}

}  // namespace

double Hull::energy(const Eigen::VectorXd& p) const {
  double sum = 0;
  each_violation(groups, p, [&](const std::vector<int>&, double, double excess) { sum += excess * excess; });
  return 0.5 * weight * sum;
}

void Hull::add_gradient(const Eigen::VectorXd& p, Eigen::VectorXd& gradient) const {
  each_violation(groups, p, [&](const std::vector<int>& members, double sign, double excess) {
    for (const int k : members) gradient[k] += weight * sign * excess;
  });
}

void Hull::add_hessian(const Eigen::VectorXd& p, Eigen::MatrixXd& hessian) const {
  each_violation(groups, p, [&](const std::vector<int>& members, double, double) {
    for (const int a : members) {
      for (const int b : members) hessian(a, b) += weight;
    }
  });
}

}  // namespace vivify::sim
