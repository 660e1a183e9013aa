// The reduced problem that block elimination leaves; elimination itself is in step_conformance_test.cpp.
#include "sim/solve/block_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

// An exact step of q.
struct Linearisation {
  Linearisation(std::uint64_t seed, double friction) : step(seed, friction, 0.01) {
    rest = step.problem->rest_point(step.q, true);
    at = forward_step(*step.problem, rest, step.x, 1e-12, *step.workspace).at;
  }
  RandomStep step;
  RestPoint rest;
  DeformedPoint at;
};

// φ(q) = objective at the exact forward step of q: its gradient and Hessian are those of the block
// elimination.
TEST(BlockSolver, IsTheReducedObjectiveAtAFeasiblePoint) {
  for (const std::uint64_t seed : {1, 5}) {
    Linearisation l(seed, 0.6);
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

// The exact Hessian need not be definite; the step goes downhill nevertheless.
TEST(BlockSolver, ReflectsNegativeCurvature) {
  int indefinite = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Linearisation l(seed, 0.5);
    const BlockSolver block(*l.step.problem, l.at, l.rest, true, *l.step.workspace);
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(block.K());
    if (eigen.eigenvalues().minCoeff() > -1e-3 * eigen.eigenvalues().maxCoeff()) continue;
    ++indefinite;
    const Vector& g = block.reduced_gradient();
    const Vector curvature = eigen.eigenvalues().cwiseAbs(), along = eigen.eigenvectors().transpose() * g;
    const Vector step = -eigen.eigenvectors() * along.cwiseQuotient(curvature);
    EXPECT_LE(relative(block.step_q(0), step), 1e-6) << "seed " << seed;
    EXPECT_LT(block.step_q(0).dot(g), 0);
    EXPECT_NEAR(block.decrement(), -0.5 * g.dot(step), 1e-9 * block.decrement());
  }
  EXPECT_GE(indefinite, 1);
}

TEST(BlockSolver, DampingTurnsTheStepToTheGradient) {
  Linearisation l(3, 1);
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
