#include "bench/ipopt/ipopt_step.h"

#include <IpIpoptApplication.hpp>
#include <IpTNLP.hpp>
#include <cmath>
#include <ctime>

#include "common/error.h"

namespace vivify::ipopt {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Ipopt::Index;
using Ipopt::Number;
using sim::DeformedPoint;
using sim::RestPoint;
using sim::StepProblem;
using sim::SymmetricMatrix;

double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

class Stopwatch {
 public:
  explicit Stopwatch(double& sum) : sum_(sum), begin_(thread_seconds()) {}
  ~Stopwatch() { sum_ += thread_seconds() - begin_; }
  Stopwatch(const Stopwatch&) = delete;

 private:
  double& sum_;
  double begin_;
};

// Variables (x, q, z), constraints (c, z − (G x − s)), all scaled.
class Program : public Ipopt::TNLP {
 public:
  explicit Program(const StepProblem& problem)
      : problem_(problem),
        n_(problem.body().dofs()),
        p_(static_cast<Index>(problem.q_n().size())),
        g_(problem.goals().size()),
        length_(problem.body().height),
        unit_(problem.body().rest->unit()),
        energy_(problem.body().weight * problem.body().height),
        goal_(std::sqrt(energy_)),
        D_(*problem.body().pattern),
        A_(*problem.body().pattern),
        identity_(MatrixXd::Identity(p_, p_)) {}

  void start(const VectorXd& x, const VectorXd& q, const Settings& settings) {
    start_ = variables(x, q);
    settings_ = settings;
    solution_ = {};
  }
  const Solution& solution() const { return solution_; }

  bool get_nlp_info(Index& n, Index& m, Index& jacobian, Index& hessian, IndexStyleEnum& style) override {
    n = n_ + p_ + g_;
    m = n_ + g_;
    const Index lower = static_cast<Index>(D_.lower().nonZeros());
    jacobian = 2 * lower - n_ + n_ * p_ + g_ * n_ + g_;
    hessian = lower + p_ * n_ + p_ * (p_ + 1) / 2 + g_;
    style = C_STYLE;
    return true;
  }

  bool get_bounds_info(Index n, Number* low, Number* high, Index m, Number* c_low, Number* c_high) override {
    VectorXd::Map(low, n).setConstant(-1e20);  // none, by Ipopt's convention
    VectorXd::Map(high, n).setConstant(1e20);
    VectorXd::Map(c_low, m).setZero();
    VectorXd::Map(c_high, m).setZero();
    return true;
  }

  bool get_starting_point(Index n, bool /*init_x*/, Number* y, bool /*init_z*/, Number* /*z_low*/,
                          Number* /*z_high*/, Index /*m*/, bool /*init_lambda*/,
                          Number* /*lambda*/) override {
    VectorXd::Map(y, n) = start_;
    return true;
  }

  bool eval_f(Index n, const Number* y, bool is_new, Number& value) override {
    const Stopwatch watch(solution_.evaluation_seconds);
    move(n, y, is_new);
    value = 0.5 * z_.squaredNorm() + rest_.regularizer / energy_;
    return std::isfinite(value);
  }

  bool eval_grad_f(Index n, const Number* y, bool is_new, Number* values) override {
    const Stopwatch watch(solution_.evaluation_seconds);
    move(n, y, is_new);
    with_derivatives();
    auto gradient = VectorXd::Map(values, n);
    gradient.head(n_).setZero();
    gradient.segment(n_, p_) = unit_ / energy_ * problem_.regularizer_gradient(rest_);
    gradient.tail(g_) = z_;
    return gradient.allFinite();
  }

  bool eval_g(Index n, const Number* y, bool is_new, Index m, Number* values) override {
    const Stopwatch watch(solution_.evaluation_seconds);
    move(n, y, is_new);
    auto c = VectorXd::Map(values, m);
    c.head(n_) = problem_.residual(at_, rest_) / problem_.body().weight;
    c.tail(g_) = z_ - problem_.goals().residual(at_.x) / goal_;
    return c.allFinite();
  }

  bool eval_jac_g(Index n, const Number* y, bool is_new, Index /*m*/, Index count, Index* row, Index* column,
                  Number* values) override {
    Entries entries{row, column, values};
    if (values != nullptr) {
      const Stopwatch watch(solution_.evaluation_seconds);
      move(n, y, is_new);
      with_derivatives();
      problem_.stiffness(at_, rest_, D_);
      fill_jacobian(entries, problem_.multiply_E(at_, rest_, identity_));
      return VectorXd::Map(values, count).allFinite();
    }
    fill_jacobian(entries, MatrixXd::Zero(n_, p_));
    return entries.count == count;
  }

  bool eval_h(Index n, const Number* y, bool is_new, Number factor, Index /*m*/, const Number* lambda,
              bool /*is_new_lambda*/, Index count, Index* row, Index* column, Number* values) override {
    Entries entries{row, column, values};
    if (values == nullptr) {
      fill_hessian(entries, 1, MatrixXd::Zero(p_, n_), MatrixXd::Zero(p_, p_));
      return entries.count == count;
    }
    const Stopwatch watch(solution_.evaluation_seconds);
    move(n, y, is_new);
    with_derivatives();
    const VectorXd force = VectorXd::Map(lambda, n_) / problem_.body().weight;
    problem_.block_A(at_, rest_, force, A_);
    // C is affine in λ: σ C(0) + (C(λ) − C(0)).
    const double share = factor / energy_;
    const MatrixXd C =
        share > 0 ? MatrixXd(share * problem_.block_C(at_, rest_, force / share))
                  : MatrixXd(problem_.block_C(at_, rest_, force) - problem_.block_C(at_, rest_, 0 * force));
    fill_hessian(entries, factor, problem_.block_B(at_, rest_, force), C);
    return VectorXd::Map(values, count).allFinite();
  }

  bool intermediate_callback(Ipopt::AlgorithmMode mode, Index iterations, Number objective,
                             Number infeasibility, Number /*inf_du*/, Number /*mu*/, Number /*d_norm*/,
                             Number /*regularization*/, Number /*alpha_du*/, Number /*alpha_pr*/,
                             Index /*ls_trials*/, const Ipopt::IpoptData*,
                             Ipopt::IpoptCalculatedQuantities*) override {
    solution_.iterations = iterations;
    return !(mode == Ipopt::RegularMode && infeasibility <= settings_.enough_residual &&
             objective * energy_ <= settings_.enough_objective);
  }

  void finalize_solution(Ipopt::SolverReturn status, Index n, const Number* y, const Number* /*z_low*/,
                         const Number* /*z_high*/, Index /*m*/, const Number* /*c*/, const Number* lambda,
                         Number /*objective*/, const Ipopt::IpoptData*,
                         Ipopt::IpoptCalculatedQuantities*) override {
    move(n, y, true);
    solution_.x = at_.x;
    solution_.q = rest_.q;
    solution_.lambda = energy_ / problem_.body().weight * VectorXd::Map(lambda, n_);
    solution_.objective = problem_.objective(at_.x, rest_);
    solution_.residual = problem_.residual(at_, rest_).lpNorm<Eigen::Infinity>() / problem_.body().weight;
    solution_.converged = status == Ipopt::SUCCESS || status == Ipopt::USER_REQUESTED_STOP;
  }

 private:
  // Either the places of all entries or their values, written in one order.
  struct Entries {
    Index* rows;
    Index* columns;
    Number* values;
    Index count = 0;
    void add(Index row, Index column, double value) {
      if (values != nullptr) {
        values[count] = value;
      } else {
        rows[count] = row;
        columns[count] = column;
      }
      ++count;
    }
  };

  VectorXd variables(const VectorXd& x, const VectorXd& q) const {
    VectorXd y(n_ + p_ + g_);
    y << x / length_, q / unit_, problem_.goals().residual(x) / goal_;
    return y;
  }

  void move(Index n, const Number* y, bool is_new) {
    if (!is_new && at_.x.size() > 0) return;
    const auto all = VectorXd::Map(y, n);
    at_ = problem_.deformed_point(length_ * all.head(n_));
    rest_ = problem_.rest_point(unit_ * all.segment(n_, p_), false);
    z_ = all.tail(g_);
  }

  void with_derivatives() {
    if (rest_.J.empty()) rest_ = problem_.rest_point(VectorXd(rest_.q), true);
  }

  void fill_jacobian(Entries& entries, const MatrixXd& E) const {
    const double weight = problem_.body().weight;
    const auto& D = D_.lower();
    for (Index column = 0; column < n_; ++column) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(D, column); it; ++it) {
        const Index row = static_cast<Index>(it.row());
        const double value = it.value() * length_ / weight;
        entries.add(row, column, value);
        if (row != column) entries.add(column, row, value);
      }
    }
    for (Index k = 0; k < p_; ++k) {
      for (Index i = 0; i < n_; ++i) entries.add(i, n_ + k, E(i, k) * unit_ / weight);
    }
    const MatrixXd& G = problem_.goals().G;
    for (Index k = 0; k < g_; ++k) {
      for (Index i = 0; i < n_; ++i) entries.add(n_ + k, i, -G(k, i) * length_ / goal_);
      entries.add(n_ + k, n_ + p_ + k, 1);
    }
  }

  void fill_hessian(Entries& entries, double factor, const MatrixXd& B, const MatrixXd& C) const {
    const auto& A = A_.lower();
    for (Index column = 0; column < n_; ++column) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(A, column); it; ++it) {
        entries.add(static_cast<Index>(it.row()), column, it.value() * length_ * length_);
      }
    }
    for (Index i = 0; i < n_; ++i) {
      for (Index k = 0; k < p_; ++k) entries.add(n_ + k, i, B(k, i) * length_ * unit_);
    }
    for (Index i = 0; i < p_; ++i) {
      for (Index k = i; k < p_; ++k) entries.add(n_ + k, n_ + i, C(k, i) * unit_ * unit_);
    }
    for (Index k = 0; k < g_; ++k) entries.add(n_ + p_ + k, n_ + p_ + k, factor);
  }

  const StepProblem& problem_;
  Index n_, p_, g_;                       // numbers of x, q and z
  double length_, unit_, energy_, goal_;  // units of x, q, the objective and z
  SymmetricMatrix D_, A_;
  MatrixXd identity_;
  VectorXd start_, z_;
  Settings settings_;
  DeformedPoint at_;
  RestPoint rest_;
  Solution solution_;
};

}  // namespace

struct Solver::Application {
  Ipopt::SmartPtr<Program> program;
  Ipopt::SmartPtr<Ipopt::IpoptApplication> ipopt;
  bool analysed = false;
};

Solver::Solver(const StepProblem& problem) : application_(std::make_unique<Application>()) {
  application_->program = new Program(problem);
  application_->ipopt = new Ipopt::IpoptApplication(false);
  const auto& options = application_->ipopt->Options();
  options->SetIntegerValue("print_level", 0);
  options->SetStringValue("sb", "yes");
  options->SetStringValue("linear_solver", "mumps");
  options->SetStringValue("nlp_scaling_method", "none");
  options->SetIntegerValue("acceptable_iter", 0);
  if (application_->ipopt->Initialize("") != Ipopt::Solve_Succeeded) {
    throw Error(ErrorKind::numerical, "Ipopt does not start");
  }
}

Solver::~Solver() = default;

Solution Solver::solve(const VectorXd& x, const VectorXd& q, const Settings& settings) {
  auto& [program, ipopt, analysed] = *application_;
  const auto& options = ipopt->Options();
  options->SetNumericValue("tol", settings.tolerance);
  options->SetNumericValue("constr_viol_tol", settings.tolerance);
  options->SetNumericValue("dual_inf_tol", settings.tolerance);
  options->SetIntegerValue("max_iter", settings.max_iterations);
  options->SetStringValue("warm_start_same_structure", analysed ? "yes" : "no");
  program->start(x, q, settings);
  const Ipopt::ApplicationReturnStatus status =
      analysed ? ipopt->ReOptimizeTNLP(GetRawPtr(program)) : ipopt->OptimizeTNLP(GetRawPtr(program));
  analysed = true;
  Solution solution = program->solution();
  solution.status = std::to_string(status);
  return solution;
}

KktError kkt_error(const StepProblem& problem, const VectorXd& x, const VectorXd& q, const VectorXd& lambda) {
  const DeformedPoint at = problem.deformed_point(x);
  const RestPoint rest = problem.rest_point(q, true);
  const double weight = problem.body().weight, height = problem.body().height;
  SymmetricMatrix D(*problem.body().pattern);
  problem.stiffness(at, rest, D);
  const VectorXd of_x = problem.goals().G.transpose() * problem.goals().residual(x) + D * lambda;
  const VectorXd of_q = problem.regularizer_gradient(rest) + problem.multiply_Et(at, rest, lambda);
  return {problem.residual(at, rest).lpNorm<Eigen::Infinity>() / weight,
          of_x.lpNorm<Eigen::Infinity>() / weight,
          of_q.lpNorm<Eigen::Infinity>() * problem.body().rest->unit() / (weight * height)};
}

}  // namespace vivify::ipopt
