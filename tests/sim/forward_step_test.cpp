// The passive step; the methods of the controlled one are in step_conformance_test.cpp.
#include "sim/solve/forward_step.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

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

// A stopped process, or one that waits for a processor, is like one that sleeps.
TEST(ForwardStep, TheTimeOfAStepIsThatOfTheProcessor) {
  const double before = processor_seconds();
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  const double slept = processor_seconds();
  EXPECT_LT(slept - before, 0.1);
  while (processor_seconds() < slept + 0.01) {
  }

  RandomStep step(1, 0.6);
  const RestPoint rest = step.problem->rest_point(step.q, false);
  step.workspace->deadline = processor_seconds() + 1000;
  EXPECT_FALSE(step.workspace->expired());
  EXPECT_TRUE(forward_step(*step.problem, rest, step.x, kFinishTolerance, *step.workspace).converged);
  step.workspace->deadline = slept;
  EXPECT_TRUE(step.workspace->expired());
  EXPECT_FALSE(forward_step(*step.problem, rest, step.x, kFinishTolerance, *step.workspace).converged);
}

}  // namespace
}  // namespace vivify::sim
