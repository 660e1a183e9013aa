// The methods find the same optimum of a step.
#include "sim/solve/step_method.h"

#include <gtest/gtest.h>

#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

// A step whose goals are asked for softly enough that the optimum is reached to all digits.
std::unique_ptr<RandomStep> tight_step(std::uint64_t seed, double goal_scale) {
  auto step = std::make_unique<RandomStep>(seed, 0.6, 0.01);
  step->body.solver.decrement = 1e-9;
  step->body.solver.small_gain = 1e-8;
  step->body.solver.max_iterations = 200;
  step->goals.G *= goal_scale;
  step->goals.s *= goal_scale;
  return step;
}

TEST(StepMethods, AgreeOnTheConvergedStep) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto owned = tight_step(seed % 10 + 1, seed <= 10 ? 0.2 : 0.5);
    RandomStep& step = *owned;
    const StepProblem& problem = *step.problem;
    const StepSolution sqp = solve_sqp(problem, problem.q_n(), step.x, *step.workspace);
    const StepSolution reduced = solve_reduced(problem, problem.q_n(), step.x, *step.workspace);
    ASSERT_TRUE(sqp.exact && reduced.exact) << "seed " << seed;
    EXPECT_NEAR(sqp.objective, reduced.objective, 1e-6 * reduced.objective) << "seed " << seed;
    for (const StepSolution* solution : {&sqp, &reduced}) {
      EXPECT_LE(solution->residual, 1e-11);
      EXPECT_LE(
          problem
              .residual(problem.deformed_point(solution->at.x), problem.rest_point(solution->rest.q, false))
              .lpNorm<Eigen::Infinity>(),
          1e-11 * step.body.weight);
      EXPECT_GE(problem.rest_point(solution->rest.q, false).smallest_element, kSmallestRest);
      // Better than leaving the rest shape alone.
      const RestPoint unchanged = problem.rest_point(problem.q_n(), true);
      const ForwardResult forward = forward_step(problem, unchanged, step.x, 1e-11, *step.workspace);
      EXPECT_LT(solution->objective, problem.objective(forward.at.x, unchanged));
    }
  }
}

TEST(StepMethods, ExactAndGaussNewtonHessiansLeadToTheSameStep) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto owned = tight_step(seed, 0.2);
    RandomStep& step = *owned;
    const StepSolution approximate = solve_sqp(*step.problem, step.problem->q_n(), step.x, *step.workspace);
    step.body.solver.exact_hessian = true;
    const StepSolution exact = solve_sqp(*step.problem, step.problem->q_n(), step.x, *step.workspace);
    ASSERT_TRUE(exact.exact && approximate.exact);
    EXPECT_NEAR(exact.objective, approximate.objective, 1e-6 * exact.objective) << "seed " << seed;
  }
}

TEST(ForwardStep, ConvergesQuadraticallyToTheMinimumOfThePotential) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    RandomStep step(seed, 0.6);
    const StepProblem& problem = *step.problem;
    const RestPoint rest = problem.rest_point(step.q, false);
    const ForwardResult forward = forward_step(problem, rest, step.x, kFinishTolerance, *step.workspace);
    ASSERT_TRUE(forward.converged);
    EXPECT_LE(forward.iterations, 20);
    EXPECT_LT(problem.potential(forward.at, rest), problem.potential(problem.deformed_point(step.x), rest));
    problem.stiffness(forward.at, rest, step.workspace->D);
    EXPECT_TRUE(step.workspace->solver.factorize(step.workspace->D)) << "a minimum";
    const ForwardResult again = forward_step(problem, rest, forward.at.x, kFinishTolerance, *step.workspace);
    EXPECT_EQ(again.iterations, 0);
  }
}

}  // namespace
}  // namespace vivify::sim
