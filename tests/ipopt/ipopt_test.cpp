// The step methods beside Ipopt on random small steps: the same objective, the same point, from the same
// start.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "bench/ipopt/ipopt_step.h"
#include "bench/ipopt/step_case.h"
#include "sim/solve/block_solver.h"

namespace vivify::ipopt {

void PrintTo(const StepCase& of, std::ostream* out) { *out << of.name(); }

namespace {

using sim::StepSolution;

constexpr double kSameObjective = 1e-6;  // relative
constexpr double kSamePlace = 1e-5;      // of the height, and of the unit of the rest space
constexpr double kStationary = 1e-6;     // see KktError

struct IpoptTest : ::testing::TestWithParam<StepCase> {
  IpoptTest() {
    step.body.solver = {.exact_hessian = true, .max_iterations = 500, .decrement = 1e-14, .small_gain = 0};
  }
  Step step{GetParam()};
  const sim::StepProblem& problem = *step.problem;
};

std::string case_name(const ::testing::TestParamInfo<StepCase>& tested) { return tested.param.name(); }
INSTANTIATE_TEST_SUITE_P(Random, IpoptTest, ::testing::ValuesIn(step_cases()), case_name);

TEST(IpoptCases, AreTwentySmallBodiesOfEveryModelAndSpace) {
  EXPECT_EQ(step_cases().size(), 20U);
  int touching = 0, damped = 0;
  for (const StepCase& of : step_cases()) {
    const Step step(of);
    EXPECT_GE(step.body.dofs(), 20) << of.name();
    EXPECT_LE(step.body.dofs(), 120) << of.name();
    EXPECT_EQ(of.ground, !step.contacts.contacts().empty()) << of.name();
    touching += of.ground ? 1 : 0;
    damped += of.damped ? 1 : 0;
  }
  EXPECT_GE(touching, 5);
  EXPECT_GE(damped, 5);
}

TEST_P(IpoptTest, SqpReachesTheSamePoint) {
  const Eigen::VectorXd start =
      start_feasibly(problem, step.q, step.x, sim::kStartTolerance, *step.workspace).at.x;
  const Solution theirs = Solver(problem).solve(start, step.q);
  ASSERT_TRUE(theirs.converged) << theirs.status;
  EXPECT_LT(theirs.objective, problem.objective(start, problem.rest_point(step.q, false)));

  const StepSolution ours = solve_sqp(problem, step.q, step.x, *step.workspace);
  EXPECT_TRUE(ours.exact);
  EXPECT_TRUE(ours.optimal);
  EXPECT_NEAR(ours.objective, theirs.objective, kSameObjective * theirs.objective);
  EXPECT_LE((ours.at.x - theirs.x).lpNorm<Eigen::Infinity>(), kSamePlace * step.body.height);
  EXPECT_LE((ours.rest.q - theirs.q).lpNorm<Eigen::Infinity>(), kSamePlace * step.body.rest->unit());

  const sim::RestPoint rest = problem.rest_point(ours.rest.q, true);
  const sim::BlockSolver block(problem, ours.at, rest, true, *step.workspace);
  ASSERT_TRUE(block.definite());
  for (const KktError& error : {kkt_error(problem, ours.at.x, ours.rest.q, block.lambda()),
                                kkt_error(problem, theirs.x, theirs.q, theirs.lambda)}) {
    EXPECT_LE(error.constraint, 10 * sim::kFinishTolerance);
    EXPECT_LE(error.x, kStationary);
    EXPECT_LE(error.q, kStationary);
  }
  // A strict minimum, not only a stationary point.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(block.K(), Eigen::EigenvaluesOnly);
  EXPECT_GT(eigen.eigenvalues().minCoeff(), 0);
}

// As the program runs, only longer: to the accuracy that is asked for.
TEST_P(IpoptTest, GaussNewtonReachesTheSameObjective) {
  const Eigen::VectorXd start =
      start_feasibly(problem, step.q, step.x, sim::kStartTolerance, *step.workspace).at.x;
  const Solution theirs = Solver(problem).solve(start, step.q);
  step.body.solver.exact_hessian = false;
  step.body.solver.decrement =
      0.5 * kSameObjective * theirs.objective / (step.body.weight * step.body.height);
  const StepSolution ours = solve_sqp(problem, step.q, step.x, *step.workspace);
  EXPECT_TRUE(ours.exact);
  EXPECT_TRUE(ours.optimal);
  EXPECT_NEAR(ours.objective, theirs.objective, kSameObjective * theirs.objective);
}

TEST_P(IpoptTest, IpoptStaysAtTheSolutionOfTheSqp) {
  const StepSolution ours = solve_sqp(problem, step.q, step.x, *step.workspace);
  const Solution theirs = Solver(problem).solve(ours.at.x, ours.rest.q);
  EXPECT_TRUE(theirs.converged) << theirs.status;
  EXPECT_LE((ours.at.x - theirs.x).lpNorm<Eigen::Infinity>(), kSamePlace * step.body.height);
  EXPECT_NEAR(theirs.objective, ours.objective, 1e-8 * ours.objective);
}

}  // namespace
}  // namespace vivify::ipopt
