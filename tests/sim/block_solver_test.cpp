// Block elimination (13)–(17) against the dense system.
#include "sim/solve/block_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

struct Linearisation {
  Linearisation(std::uint64_t seed, double friction, bool feasible) : step(seed, friction, 0.01) {
    const StepProblem& problem = *step.problem;
    rest = problem.rest_point(step.q, true);
    const ForwardResult forward = forward_step(problem, rest, step.x, feasible ? 1e-12 : 10, *step.workspace);
    at = forward.at;
    if (!feasible) {  // a little off the constraint
      CounterRng rng(seed);
      const ForwardResult near = forward_step(problem, rest, step.x, 1e-3, *step.workspace);
      at = problem.deformed_point(near.at.x + random_vector(step.x.size(), 1e-3, rng));
    }
  }
  RandomStep step;
  RestPoint rest;
  DeformedPoint at;
};

class Elimination : public ::testing::TestWithParam<std::tuple<bool, double, int>> {};

TEST_P(Elimination, SolvesTheDenseSystem) {
  const auto& [exact, friction, seed] = GetParam();
  Linearisation l(static_cast<std::uint64_t>(seed), friction, false);
  const StepProblem& problem = *l.step.problem;
  const BlockSolver block(problem, l.at, l.rest, exact, *l.step.workspace);
  ASSERT_TRUE(block.definite());
  const Vector& lambda = block.lambda();
  const Vector dq = block.step_q(0), dx = block.step_x(dq);

  const Eigen::Index n = l.at.x.size(), m = l.rest.q.size();
  SymmetricMatrix stiffness(*l.step.body.pattern), part(*l.step.body.pattern);
  problem.stiffness(l.at, l.rest, stiffness);
  const Matrix D = dense(stiffness), E = problem.multiply_E(l.at, l.rest, Matrix::Identity(m, m));
  const Matrix& G = problem.goals().G;
  Matrix A = G.transpose() * G, B = Matrix::Zero(m, n), C = problem.regularizer_gauss_newton(l.rest);
  if (exact) {
    problem.block_A(l.at, l.rest, lambda, part);
    A += dense(part);
    B = problem.block_B(l.at, l.rest, lambda);
    C = problem.block_C(l.at, l.rest, lambda);
  }
  // ∂L/∂x = 0 by the choice of λ.
  const Vector goal_force = G.transpose() * problem.goals().residual(l.at.x);
  EXPECT_LE((goal_force + D * lambda).norm(), 1e-9 * goal_force.norm());

  Matrix kkt = Matrix::Zero(2 * n + m, 2 * n + m);
  kkt.block(0, 0, n, n) = A;
  kkt.block(0, n, n, m) = B.transpose();
  kkt.block(0, n + m, n, n) = D.transpose();
  kkt.block(n, 0, m, n) = B;
  kkt.block(n, n, m, m) = C;
  kkt.block(n, n + m, m, n) = E.transpose();
  kkt.block(n + m, 0, n, n) = D;
  kkt.block(n + m, n, n, m) = E;
  Vector rhs(2 * n + m);
  rhs << goal_force + D * lambda, problem.regularizer_gradient(l.rest) + E.transpose() * lambda,
      problem.residual(l.at, l.rest);
  const Eigen::FullPivLU<Matrix> lu(kkt);
  Vector solution = -lu.solve(rhs);
  solution -= lu.solve(kkt * solution + rhs);

  const Matrix F = D.ldlt().solve(E);
  const Matrix K = C - B * F - F.transpose() * B.transpose() + F.transpose() * A * F;
  EXPECT_LE(relative(block.K(), K), 1e-9);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix>(K).eigenvalues().minCoeff(),
            0);  // otherwise it is reflected
  EXPECT_GT(dq.norm(), 1e-4);
  EXPECT_LE(relative(dq, solution.segment(n, m)), 1e-9);
  EXPECT_LE(relative(dx, solution.head(n)), 1e-9);
  // Newton's equation of the linearised constraint holds for any dq.
  CounterRng rng(5);
  const Vector other = random_vector(m, 0.1, rng);
  EXPECT_LE((D * block.step_x(other) + E * other + block.residual()).norm(), 1e-9 * block.residual().norm());
}

INSTANTIATE_TEST_SUITE_P(States, Elimination,
                         ::testing::Combine(::testing::Bool(), ::testing::Values(0.5, INFINITY),
                                            ::testing::Values(1, 3, 4, 5)));

TEST(BlockSolver, ReflectsNegativeCurvature) {
  Linearisation l(2, 0.5, false);
  const BlockSolver block(*l.step.problem, l.at, l.rest, true, *l.step.workspace);
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(block.K());
  ASSERT_LT(eigen.eigenvalues().minCoeff(), -1);
  const Matrix reflected =
      eigen.eigenvectors() * eigen.eigenvalues().cwiseAbs().asDiagonal() * eigen.eigenvectors().transpose();
  EXPECT_NEAR(block.decrement(),
              0.5 * block.reduced_gradient().dot(reflected.ldlt().solve(block.reduced_gradient())),
              1e-9 * block.decrement());
}

// φ(q) = objective at the exact forward step of q: its gradient and Hessian are those of the block
// elimination.
TEST(BlockSolver, IsTheReducedObjectiveAtAFeasiblePoint) {
  for (const std::uint64_t seed : {1, 5}) {
    Linearisation l(seed, 0.6, true);
    const StepProblem& problem = *l.step.problem;
    const auto solve = [&](const Vector& q) {
      const ForwardResult forward =
          forward_step(problem, problem.rest_point(q, true), l.at.x, 1e-13, *l.step.workspace);
      EXPECT_LE(forward.residual, 1e-11);
      return forward.at;
    };
    const auto objective = [&](const Vector& q) {
      return Vector::Constant(1, problem.objective(solve(q).x, problem.rest_point(q, false)));
    };
    const auto gradient = [&](const Vector& q) {
      const DeformedPoint at = solve(q);
      const RestPoint rest = problem.rest_point(q, true);
      return Vector(BlockSolver(problem, at, rest, false, *l.step.workspace).reduced_gradient());
    };
    const Vector g = gradient(l.step.q);
    EXPECT_LE(relative(g.transpose(), differences(objective, l.step.q, 1e-5)), 1e-6);
    const Matrix H = differences(gradient, l.step.q, 1e-5);
    const BlockSolver exact(problem, l.at, l.rest, true, *l.step.workspace);
    EXPECT_LE(relative(exact.K(), H), 1e-4);
    const BlockSolver approximate(problem, l.at, l.rest, false, *l.step.workspace);
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix>(approximate.K()).eigenvalues().minCoeff(), 0);
    EXPECT_GT(relative(approximate.K(), H), 1e-4);  // it leaves something out
  }
}

TEST(BlockSolver, DampingTurnsTheStepToTheGradient) {
  Linearisation l(3, 1, true);
  const BlockSolver block(*l.step.problem, l.at, l.rest, false, *l.step.workspace);
  const Vector scaled = -block.reduced_gradient().cwiseQuotient(block.K().diagonal());
  double last = INFINITY;
  for (const double mu : {0.0, 0.1, 1.0, 10.0, 1e6}) {
    const Vector dq = block.step_q(mu);
    EXPECT_LT(dq.norm(), last);
    EXPECT_LT(dq.dot(block.reduced_gradient()), 0);
    last = dq.norm();
  }
  EXPECT_NEAR(block.step_q(1e9).normalized().dot(scaled.normalized()), 1, 1e-6);
  const Vector dq = block.step_q(0);
  const double slope = dq.dot(block.reduced_gradient());
  EXPECT_NEAR(block.slope(block.step_x(dq), dq), slope, 1e-6 * std::abs(slope));
  EXPECT_NEAR(block.decrement(), -0.5 * slope, 1e-6 * block.decrement());
}

TEST(LinearSolver, TellsIndefiniteMatrices) {
  SymmetricPattern pattern(2, 3);
  const std::array<int, 2> pair = {0, 1};
  pattern.couple(pair.data(), 2);
  pattern.finish();
  EXPECT_EQ(pattern.zeros().nonZeros(), 21);
  SymmetricMatrix matrix(pattern);
  for (int i = 0; i < 6; ++i) matrix.values()[pattern.slot(i, i)] = 2;
  matrix.values()[pattern.slot(4, 1)] = 1;
  EXPECT_EQ(pattern.slot(1, 1) >= 0, true);
  LinearSolver solver(pattern);
  EXPECT_TRUE(solver.factorize(matrix));
  const Matrix x = solver.solve(Vector::Ones(6));
  EXPECT_LE((matrix * x - Vector::Ones(6)).norm(), 1e-14);
  matrix.values()[pattern.slot(4, 1)] = 3;
  EXPECT_FALSE(solver.factorize(matrix));
}

}  // namespace
}  // namespace vivify::sim
