#include <Eigen/Dense>

#include "bench/validation/bodies.h"
#include "bench/validation/problem.h"
#include "common/error.h"
#include "sim/solve/block_solver.h"

namespace vivify::validation {
namespace {

struct Difference {
  Largest step, K;
};

// The step of the block elimination beside the dense solution of (13), with the exact blocks or those of
// Gauss–Newton.
Difference compare(const StepState& state, bool exact) {
  const sim::StepProblem& problem = *state.problem;
  sim::StepWorkspace workspace(*state.body.pattern);
  const sim::RestPoint rest = problem.rest_point(state.q, true);
  // Near enough to the constraint that D is definite.
  const sim::DeformedPoint at = forward_step(problem, rest, state.x, 1e-2, workspace).at;
  const sim::BlockSolver block(problem, at, rest, exact, workspace);
  if (!block.definite()) throw Error(ErrorKind::numerical, "the stiffness of a random state is indefinite");
  const Vector dq = block.step_q(0), dx = block.step_x(dq), lambda = block.lambda();

  const Eigen::Index n = at.x.size(), m = rest.q.size();
  sim::SymmetricMatrix stiffness(*state.body.pattern), part(*state.body.pattern);
  problem.stiffness(at, rest, stiffness);
  const Matrix one = Matrix::Identity(n, n), D = stiffness * one,
               E = problem.multiply_E(at, rest, Matrix::Identity(m, m)), G = problem.goals().G;
  Matrix A = G.transpose() * G, B = Matrix::Zero(m, n), C = problem.regularizer_gauss_newton(rest);
  if (exact) {
    problem.block_A(at, rest, lambda, part);
    A += part * one;
    B = problem.block_B(at, rest, lambda);
    C = problem.block_C(at, rest, lambda);
  }
  Matrix kkt = Matrix::Zero(2 * n + m, 2 * n + m);
  kkt << A, B.transpose(), D, B, C, E.transpose(), D, E, Matrix::Zero(n, n);
  Vector rhs(2 * n + m);
  rhs << G.transpose() * problem.goals().residual(at.x) + D * lambda,
      problem.regularizer_gradient(rest) + E.transpose() * lambda, problem.residual(at, rest);
  const Eigen::PartialPivLU<Matrix> lu(kkt);
  Vector solution = -lu.solve(rhs);
  for (int i = 0; i < 3; ++i) solution -= lu.solve(kkt * solution + rhs);

  const Matrix F = D.ldlt().solve(E), K = C - B * F - F.transpose() * B.transpose() + F.transpose() * A * F;
  Vector ours(n + m);
  ours << dx, dq;
  Difference difference;
  // Beside the part that comes from the motion: the regulariser is on both sides the same sum.
  difference.K.add((block.K() - K).norm() / (K - problem.regularizer_gauss_newton(rest)).norm());
  // Where the exact K is indefinite, its negative curvature is reflected: another step, on purpose.
  if (Eigen::LLT<Matrix>(K).info() == Eigen::Success) {
    difference.step.add((ours - solution.head(n + m)).norm() / solution.head(n + m).norm());
  }
  return difference;
}

}  // namespace

Result elimination(Effort effort) {
  Result result;
  result.title = "Block elimination beside the dense system";
  result.text =
      "The step (δx, δq) of the block elimination (13)–(17) beside a dense LU factorisation of the whole "
      "system (13) "
      "with iterative refinement, for random states with goals, for every model and rest space: with the "
      "blocks of "
      "Gauss–Newton and with the exact ones, and the reduced matrix K. Where the exact K is indefinite its "
      "negative "
      "curvature is reflected and only K is compared.";
  const int states = effort == Effort::full ? 10 : 2;
  Plot plot{"elimination",
            "Block elimination beside the dense system",
            "combination of model and rest space",
            "relative difference",
            false,
            true};
  Curve gauss_newton{"step, Gauss–Newton"}, exact_step{"step, exact"}, exact_K{"K, exact"},
      tolerance{"tolerance", {}, {}, true};
  Table table{"Largest relative differences.",
              {"number", "model", "rest space", "step, Gauss–Newton", "step, exact", "K, exact"}};
  int number = 0;
  Largest largest;
  for (const Sample& sample : samples()) {
    for (const std::string space : {"full", "cage", "examples"}) {
      Difference approximate, exact;
      for (int s = 0; s < states; ++s) {
        const StepState state(sample, space, static_cast<std::uint64_t>(s));
        const Difference a = compare(state, false), b = compare(state, true);
        approximate.step.add(a.step.value);
        approximate.K.add(a.K.value);
        exact.step.add(b.step.value);
        exact.K.add(b.K.value);
      }
      ++number;
      gauss_newton.add(number, approximate.step.value);
      if (exact.step.value > 0) exact_step.add(number, exact.step.value);
      exact_K.add(number, exact.K.value);
      tolerance.add(number, 1e-9);
      for (const Largest& part : {approximate.step, approximate.K, exact.step, exact.K})
        largest.add(part.value);
      table.rows.push_back({std::to_string(number), sample.model, space, short_number(approximate.step.value),
                            short_number(exact.step.value), short_number(exact.K.value)});
    }
  }
  result.figure("largest relative difference of all", largest.value, 0, 1e-9);
  plot.curves = {gauss_newton, exact_step, exact_K, tolerance};
  result.plots.push_back(std::move(plot));
  result.tables.push_back(std::move(table));
  return result;
}

}  // namespace vivify::validation
