// Every model with every rest space in a step with contacts and goals: the blocks of (13) against
// differences, their elimination against the dense system, and the step methods against each other.
#include <Eigen/Dense>

#include "sim/control/rigid_motion.h"
#include "sim/solve/block_solver.h"
#include "sim/solve/step_method.h"
#include "tests/sim/conformance.h"

namespace vivify::sim {
namespace {

INSTANTIATE_TEST_SUITE_P(Every, StepConformance,
                         ::testing::ValuesIn(body_cases(elastic_models(), rest_spaces())), case_name);

constexpr double kFriction = 0.5;
const char* const kDamped = "damping_s: 0.02";

// The functions of a step at one place, as functions of x and q.
struct Blocks {
  Blocks(RandomStep& of, const StepProblem& in) : step(of), problem(in), n(of.x.size()), m(of.q.size()) {}

  RestPoint rest(const Vector& q) const { return problem.rest_point(q, true); }
  DeformedPoint at(const Vector& x) const { return problem.deformed_point(x); }
  Vector residual(const Vector& x, const Vector& q) const { return problem.residual(at(x), rest(q)); }
  Matrix D(const Vector& x, const Vector& q) const {
    problem.stiffness(at(x), rest(q), step.workspace->D);
    return dense(step.workspace->D);
  }
  Matrix E(const Vector& x, const Vector& q) const {
    return problem.multiply_E(at(x), rest(q), Matrix::Identity(m, m));
  }
  Vector Et(const Vector& x, const Vector& q, const Vector& y) const {
    return problem.multiply_Et(at(x), rest(q), y);
  }
  Matrix A(const Vector& x, const Vector& q, const Vector& lambda) const {
    problem.block_A(at(x), rest(q), lambda, step.workspace->block);
    return dense(step.workspace->block);
  }
  Matrix B(const Vector& x, const Vector& q, const Vector& lambda) const {
    return problem.block_B(at(x), rest(q), lambda);
  }
  Matrix C(const Vector& x, const Vector& q, const Vector& lambda) const {
    return problem.block_C(at(x), rest(q), lambda);
  }

  RandomStep& step;
  const StepProblem& problem;
  Eigen::Index n, m;
};

TEST_P(StepConformance, BlocksMatchDifferences) {
  for (const char* damping : {"", kDamped}) {
    RandomStep step(GetParam(), {.model = damping}, 42, kFriction, 0.01);
    EXPECT_GE(step.pressing, 2);
    EXPECT_GE(step.above, 2);
    EXPECT_GE(step.sticking, 1);
    EXPECT_GE(step.slipping, 1);
    const Blocks f(step, *step.problem);
    CounterRng rng(1);
    const Vector &x = step.x, &q = step.q, lambda = random_vector(f.n, 0.1, rng), none = Vector::Zero(f.n);
    const double eps = std::min(1e-6, 0.1 * step.room), eps_q = 1e-6 * step.body.rest->unit();
    const auto potential = [&](const Vector& y) {
      return Vector::Constant(1, f.problem.potential(f.at(y), f.rest(q)));
    };
    EXPECT_LE(relative(f.residual(x, q).transpose(), differences(potential, x, eps)), 1e-6);
    EXPECT_LE(relative(f.D(x, q), differences([&](const Vector& y) { return f.residual(y, q); }, x, eps)),
              1e-6);
    const Matrix E = f.E(x, q);
    EXPECT_LE(relative(E, differences([&](const Vector& r) { return f.residual(x, r); }, q, eps_q)), 1e-6);
    const Matrix Et = f.problem.multiply_Et(f.at(x), f.rest(q), Matrix::Identity(f.n, f.n));
    EXPECT_LE(relative(Et.transpose(), E), 1e-14);
    const Vector y = random_vector(f.n, 1, rng), dq = random_vector(f.m, 1, rng);
    const double product = y.dot(f.problem.multiply_E(f.at(x), f.rest(q), dq).col(0));
    EXPECT_NEAR(f.Et(x, q, y).dot(dq), product, 1e-12 * E.norm() * y.norm() * dq.norm());

    const auto D_lambda = [&](const Vector& z) -> Vector { return f.D(z, q) * lambda; };
    EXPECT_LE(relative(f.A(x, q, lambda), differences(D_lambda, x, eps)), 1e-6);
    const Matrix B = f.B(x, q, lambda);
    EXPECT_LE(relative(B, differences([&](const Vector& z) { return f.Et(z, q, lambda); }, x, eps)), 1e-6);
    const auto D_lambda_of_q = [&](const Vector& r) -> Vector { return f.D(x, r) * lambda; };
    EXPECT_LE(relative(B.transpose(), differences(D_lambda_of_q, q, eps_q)), 1e-6);
    // The parts of C one by one, so that neither hides the other.
    const Matrix C_r = f.C(x, q, none), C_c = f.C(x, q, lambda) - C_r;
    const auto regularizer = [&](const Vector& r) { return Vector::Constant(1, f.rest(r).regularizer); };
    const auto gradient = [&](const Vector& r) { return f.problem.regularizer_gradient(f.rest(r)); };
    EXPECT_LE(relative(gradient(q).transpose(), differences(regularizer, q, eps_q)), 1e-6);
    EXPECT_LE(relative(C_r, differences(gradient, q, eps_q)), 1e-6);
    const Matrix differenced = differences([&](const Vector& r) { return f.Et(x, r, lambda); }, q, eps_q);
    EXPECT_LE((C_c - differenced).norm(), 1e-6 * std::max(C_c.norm(), f.Et(x, q, lambda).norm()));
  }
}

// Without the contacts, whose regimes leave no room for larger steps.
TEST_P(StepConformance, DifferencesConvergeInSecondOrder) {
  RandomStep step(GetParam(), {.model = kDamped}, 43, kFriction, 0.01);
  const Blocks f(step, *step.in_air);
  CounterRng rng(2);
  const Vector &x = step.x, &q = step.q, lambda = random_vector(f.n, 0.1, rng);
  const Vector l = random_vector(f.n, 1, rng), r = random_vector(f.m, step.body.rest->unit(), rng);
  const double eps = 3e-4;
  EXPECT_TRUE(converges([&](const Vector& y) { return f.residual(y, q); }, x, l, f.D(x, q) * l, eps));
  EXPECT_TRUE(converges([&](const Vector& p) { return f.residual(x, p); }, q, r, f.E(x, q) * r, eps));
  EXPECT_TRUE(converges([&](const Vector& y) -> Vector { return f.D(y, q) * lambda; }, x, l,
                        f.A(x, q, lambda) * l, eps));
  EXPECT_TRUE(
      converges([&](const Vector& y) { return f.Et(y, q, lambda); }, x, l, f.B(x, q, lambda) * l, eps));
  EXPECT_TRUE(converges(
      [&](const Vector& p) -> Vector {
        return f.Et(x, p, lambda) + f.problem.regularizer_gradient(f.rest(p));
      },
      q, r, f.C(x, q, lambda) * r, eps));
}

// Also with damping, and whatever the rest shape is.
TEST_P(StepConformance, InternalForcesKeepMomentum) {
  RandomStep still(GetParam(), {.model = ""}, 5, kFriction, 0.01),
      damped(GetParam(), {.model = kDamped}, 5, kFriction, 0.01);
  const Blocks f(damped, *damped.problem);
  const Vector g = f.problem.internal_gradient(0, f.at(damped.x), f.rest(damped.q));
  const Vector undamped = still.problem->internal_gradient(0, still.problem->deformed_point(damped.x),
                                                           still.problem->rest_point(damped.q, false));
  EXPECT_GT((g - undamped).norm(), 1e-3 * g.norm()) << "damping acts";
  const int d = damped.body.dimension();
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), torque = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < g.size() / d; ++i) {
    force += spatial_point(g, i, d);
    torque += spatial_point(damped.x, i, d).cross(spatial_point(g, i, d));
  }
  EXPECT_LE(force.norm(), 1e-12 * g.norm());
  EXPECT_LE(torque.norm(), 1e-12 * g.norm());
}

// The dense system (13), solved as a whole. Where the reduced Hessian is indefinite, BlockSolver reflects its
// negative curvature: the step along those eigenvectors turns round.
TEST_P(StepConformance, EliminationSolvesTheDenseSystem) {
  for (const bool exact : {false, true}) {
    RandomStep step(GetParam(), {.model = kDamped}, 3, kFriction, 0.01);
    const StepProblem& problem = *step.problem;
    const Blocks f(step, problem);
    const RestPoint rest = f.rest(step.q);
    const ForwardResult near = forward_step(problem, rest, step.x, 1e-3, *step.workspace);
    CounterRng rng(3);
    const DeformedPoint at = f.at(near.at.x + random_vector(f.n, 1e-4, rng));  // a little off the constraint
    const BlockSolver block(problem, at, rest, exact, *step.workspace);
    ASSERT_TRUE(block.definite());
    const Vector lambda = block.lambda(), dq = block.step_q(0), dx = block.step_x(dq);

    const Eigen::Index n = f.n, m = f.m;
    const Matrix D = f.D(at.x, step.q), E = f.E(at.x, step.q), &G = problem.goals().G;
    Matrix A = G.transpose() * G, B = Matrix::Zero(m, n), C = problem.regularizer_gauss_newton(rest);
    if (exact) {
      A += f.A(at.x, step.q, lambda);
      B = f.B(at.x, step.q, lambda);
      C = f.C(at.x, step.q, lambda);
    }
    const Vector goal_force = G.transpose() * problem.goals().residual(at.x);
    EXPECT_LE((goal_force + D * lambda).norm(), 1e-9 * goal_force.norm());

    using Extended = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
    Extended kkt = Extended::Zero(2 * n + m, 2 * n + m), rhs(2 * n + m, 1);
    const auto put = [&kkt](Eigen::Index row, Eigen::Index column, const Matrix& block_of) {
      kkt.block(row, column, block_of.rows(), block_of.cols()) = block_of.cast<long double>();
      kkt.block(column, row, block_of.cols(), block_of.rows()) = block_of.transpose().cast<long double>();
    };
    put(0, 0, A);
    put(n, 0, B);
    put(n, n, C);
    put(n + m, 0, D);
    put(n + m, n, E);
    rhs << (goal_force + D * lambda).cast<long double>(),
        (problem.regularizer_gradient(rest) + E.transpose() * lambda).cast<long double>(),
        problem.residual(at, rest).cast<long double>();
    const Vector solution = -kkt.partialPivLu().solve(rhs).cast<double>();

    const Matrix F = D.ldlt().solve(E);
    const Matrix K = C - B * F - F.transpose() * B.transpose() + F.transpose() * A * F;
    EXPECT_LE(relative(block.K(), K), 1e-9);
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(0.5 * (K + K.transpose()));
    if (!exact) {
      EXPECT_GT(eigen.eigenvalues().minCoeff(), 0);
    }
    const Vector newton = solution.segment(n, m);
    const Vector expected = eigen.eigenvectors() * eigen.eigenvalues().cwiseSign().asDiagonal() *
                            eigen.eigenvectors().transpose() * newton;
    EXPECT_LE(relative(dq, expected), 1e-9);
    if (eigen.eigenvalues().minCoeff() > 0) {
      EXPECT_LE(relative(dx, solution.head(n)), 1e-9);
    }
    // Newton's equation of the linearised constraint holds for any dq.
    const Vector other = random_vector(m, 0.1 * step.body.rest->unit(), rng);
    EXPECT_LE((D * block.step_x(other) + E * other + block.residual()).norm(),
              1e-9 * (E * other + block.residual()).norm());
  }
}

TEST_P(StepConformance, MethodsFindTheSameOptimum) {
  for (const std::uint64_t seed : {1, 2}) {
    RandomStep step(GetParam(), {.model = kDamped}, seed, kFriction, 0.01);
    step.body.solver = {.max_iterations = 500, .decrement = 1e-12, .small_gain = 0};
    const StepProblem& problem = *step.problem;
    const RestPoint unchanged = problem.rest_point(problem.q_n(), true);
    const ForwardResult forward = forward_step(problem, unchanged, step.x, kFinishTolerance, *step.workspace);
    ASSERT_TRUE(forward.converged);
    const double before = problem.objective(forward.at.x, unchanged);
    std::vector<StepSolution> solutions;
    for (const StepMethodEntry& method : step_methods()) {
      for (const bool exact : {false, true}) {
        step.body.solver.exact_hessian = exact;
        const StepSolution solution = method.solve(problem, problem.q_n(), step.x, *step.workspace);
        const std::string name =
            std::string(method.name) + (exact ? ", exact Hessian" : "") + ", seed " + std::to_string(seed);
        EXPECT_TRUE(solution.exact) << name;
        EXPECT_LE(
            problem
                .residual(problem.deformed_point(solution.at.x), problem.rest_point(solution.rest.q, false))
                .lpNorm<Eigen::Infinity>(),
            kFinishTolerance * step.body.weight)
            << name;
        EXPECT_LT(solution.objective, before) << name;
        EXPECT_GE(solution.rest.smallest_element, kSmallestRest) << name;
        solutions.push_back(solution);
        EXPECT_NEAR(solution.objective, solutions[0].objective, 1e-6 * solutions[0].objective) << name;
        EXPECT_LE((solution.at.x - solutions[0].at.x).lpNorm<Eigen::Infinity>(), 5e-5 * step.body.height)
            << name;
      }
    }
  }
}

}  // namespace
}  // namespace vivify::sim
