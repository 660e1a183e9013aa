#include "sim/solve/static_solve.h"

#include <algorithm>
#include <cmath>

namespace vivify::sim {
namespace {

constexpr int kMaxIterations = 500;
constexpr int kMaxHalvings = 40;
constexpr double kArmijo = 1e-4;
constexpr double kLeastShift = 1e-9;  // of the largest diagonal entry: rigid motions have no stiffness
constexpr double kFirstShift = 1e-6;  // where that is not enough
constexpr double kMostShift = 1e6;
constexpr double kRaise = 4, kLower = 10;

struct Evaluation {
  double energy = 0;
  Eigen::VectorXd gradient;  // zero on held vertices
};

class Solver {
 public:
  explicit Solver(const StaticProblem& problem) : problem_(problem) {
    const int d = problem.pattern.dimension();
    for (int i = 0; i < problem.pattern.size(); ++i)
      held_.push_back(problem.held[static_cast<std::size_t>(i / d)]);
  }

  Evaluation evaluate(const Eigen::VectorXd& x) const {
    Evaluation result{-problem_.force.dot(x), -problem_.force};
    Eigen::VectorXd s, g;
    for (std::size_t f = 0; f < problem_.families.size(); ++f) {
      const MeasureFamily& family = *problem_.families[f];
      family.gradients(Side::deformed, x, s, g);
      const MeasureValues at = {family.coefficients(), s, problem_.S[f]};
      result.energy += family.law().energy(at);
      family.scatter(Side::deformed, g, family.law().stress(at), result.gradient);
    }
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      if (held_[static_cast<std::size_t>(i)]) result.gradient[i] = 0;
    }
    return result;
  }

  // Stiffness with rows and columns of held coordinates replaced by those of the identity. Returns its
  // largest diagonal entry.
  double stiffness(const Eigen::VectorXd& x, SymmetricMatrix& D) const {
    D.set_zero();
    Eigen::VectorXd s, g;
    for (std::size_t f = 0; f < problem_.families.size(); ++f) {
      const MeasureFamily& family = *problem_.families[f];
      family.gradients(Side::deformed, x, s, g);
      const MeasureValues at = {family.coefficients(), s, problem_.S[f]};
      family.add_hessians(x, g, family.law().stiffness(at), family.law().stress(at), D);
    }
    double largest = 0;
    each_entry(D, [&](Eigen::Index row, Eigen::Index column, double& value) {
      if (held_[static_cast<std::size_t>(row)] || held_[static_cast<std::size_t>(column)]) {
        value = row == column ? 1 : 0;
      } else if (row == column) {
        largest = std::max(largest, std::abs(value));
      }
    });
    return largest;
  }

  static void add_diagonal(double shift, SymmetricMatrix& D) {
    each_entry(D, [&](Eigen::Index row, Eigen::Index column, double& value) {
      if (row == column) value += shift;
    });
  }

 private:
  template <class Visit>
  static void each_entry(SymmetricMatrix& D, const Visit& visit) {
    for (Eigen::Index column = 0; column < D.lower().outerSize(); ++column) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(D.lower(), column); it; ++it) {
        visit(it.row(), column, it.valueRef());
      }
    }
  }

  const StaticProblem& problem_;
  std::vector<bool> held_;  // per coordinate
};

}  // namespace

StaticSolution solve_static(const StaticProblem& problem, Eigen::VectorXd x, double tolerance) {
  const Solver solver(problem);
  SymmetricMatrix D(problem.pattern);
  LinearSolver linear(problem.pattern);
  StaticSolution solution;
  Evaluation now = solver.evaluate(x);
  double damping = kLeastShift;  // added to the diagonal of the stiffness, in units of its largest entry
  for (;; ++solution.iterations) {
    solution.residual = now.gradient.size() == 0 ? 0 : now.gradient.lpNorm<Eigen::Infinity>();
    solution.converged = solution.residual <= tolerance && now.gradient.allFinite();
    if (solution.converged || solution.iterations == kMaxIterations || !std::isfinite(now.energy)) break;

    const double unit = solver.stiffness(x, D);
    Solver::add_diagonal(damping * unit, D);
    while (!linear.factorize(D) && damping < kMostShift) {
      const double more = std::max(kRaise * damping, kFirstShift);
      Solver::add_diagonal((more - damping) * unit, D);
      damping = more;
    }
    if (!(damping < kMostShift)) break;
    const Eigen::VectorXd step = -linear.solve(now.gradient);
    const double slope = now.gradient.dot(step);
    bool accepted = false;
    double alpha = 1;
    int halving = 0;
    for (; halving < kMaxHalvings && !accepted; ++halving, alpha *= 0.5) {
      Eigen::VectorXd trial = x + alpha * step;
      Evaluation there = solver.evaluate(trial);
      // Near the solution the energy is flat to rounding; there the gradient itself must shrink.
      accepted = there.energy <= now.energy + kArmijo * alpha * slope ||
                 there.gradient.norm() <= 0.5 * now.gradient.norm();
      if (!accepted) continue;
      x = std::move(trial);
      now = std::move(there);
    }
    if (!accepted) break;
    // A step that was taken whole earns less damping; one that had to be cut short asks for more.
    damping = halving == 1  ? std::max(damping / kLower, kLeastShift)
              : halving > 2 ? std::max(kRaise * damping, kFirstShift)
                            : damping;
  }
  solution.x = std::move(x);
  solution.energy = now.energy;
  return solution;
}

}  // namespace vivify::sim
