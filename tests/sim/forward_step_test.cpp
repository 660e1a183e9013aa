// The passive step; the methods of the controlled one are in step_conformance_test.cpp.
#include "sim/solve/forward_step.h"

#include <gtest/gtest.h>

#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

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
