// Parts of the step problem: contacts that press, stick and slip, the regulariser, inertia. The blocks of
// every model and rest space are in step_conformance_test.cpp.
#include "sim/solve/step_problem.h"

#include <gtest/gtest.h>

#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

class ContactDerivatives : public ::testing::TestWithParam<double> {};

// The contacts alone, so that no stiff element hides them.
TEST_P(ContactDerivatives, ForcesStiffnessAndBlockA) {
  const RandomStep step(42, GetParam());
  EXPECT_GE(step.pressing, 5);
  EXPECT_GE(step.above, 3);
  EXPECT_GE(step.sticking, 3);
  if (!std::isinf(GetParam())) {
    EXPECT_GE(step.slipping, 3);
  }
  CounterRng rng(1);
  const Vector lambda = random_vector(step.x.size(), 1e-3, rng);
  const Vector direction = random_vector(step.x.size(), 1, rng);
  const ContactSet& contacts = step.contacts;
  const auto energy = [&](const Vector& x) { return Vector::Constant(1, contacts.energy(x)); };
  const auto gradient = [&](const Vector& x) {
    Vector g = Vector::Zero(x.size());
    contacts.add_gradient(x, g);
    return g;
  };
  SymmetricMatrix H(*step.body.pattern), A(*step.body.pattern);
  contacts.add_hessian(step.x, step.body.contact_slots, H);
  contacts.add_block_a(step.x, lambda, step.body.contact_slots, A);
  const auto hessian_lambda = [&](const Vector& x) {
    SymmetricMatrix at_x(*step.body.pattern);
    contacts.add_hessian(x, step.body.contact_slots, at_x);
    return Vector(at_x * lambda);
  };
  const double eps = 1e-3 * step.room;
  EXPECT_LE(relative(gradient(step.x).transpose(), differences(energy, step.x, eps)), 1e-6);
  EXPECT_LE(relative(dense(H), differences(gradient, step.x, eps)), 1e-6);
  EXPECT_LE(relative(dense(A), differences(hessian_lambda, step.x, eps)), 1e-6);
  if (!std::isinf(GetParam())) {  // otherwise all is quadratic or cubic, and only the first has an error
    EXPECT_NEAR(convergence(gradient, step.x, direction, dense(H) * direction, 0.2 * step.room), 4, 0.1);
    EXPECT_NEAR(convergence(hessian_lambda, step.x, direction, dense(A) * direction, 0.2 * step.room), 4,
                0.1);
  }
  EXPECT_NEAR(convergence(energy, step.x, direction, Vector::Constant(1, gradient(step.x).dot(direction)),
                          0.2 * step.room),
              4, 0.1);
  const Eigen::Vector3d force = contacts.total_force(step.x);
  const Points nodal = rows(gradient(step.x));
  EXPECT_LE((nodal.colwise().sum().transpose() + force).norm(), 1e-12 * force.norm());
}

std::string friction_name(const ::testing::TestParamInfo<double>& tested) {
  return std::isinf(tested.param) ? "infinite" : "mu" + std::to_string(static_cast<int>(10 * tested.param));
}
INSTANTIATE_TEST_SUITE_P(Friction, ContactDerivatives, ::testing::Values(1.0, 0.3, INFINITY), friction_name);

TEST(Regularizer, IsZeroAtTheInitialShapeAndAfterNoChange) {
  const RandomStep step(3, 1);
  const Vector zero = Vector::Zero(step.q.size());
  const StepProblem still(step.body, step.contacts, step.goals, step.x, step.x, zero, 1.0 / 48);
  const RestPoint rest = still.rest_point(zero, true);
  EXPECT_EQ(rest.regularizer, 0);
  EXPECT_EQ(still.regularizer_gradient(rest).norm(), 0);
  EXPECT_EQ(rest.smallest_element, 1);
}

TEST(Regularizer, GaussNewton) {
  const RandomStep step(4, 1);
  const StepProblem& problem = *step.problem;
  const RestPoint rest = problem.rest_point(step.q, true);
  // Gauss–Newton is the exact Hessian where the residuals vanish, up to the rate term both share.
  const RestPoint initial = problem.rest_point(Vector::Zero(step.q.size()), true);
  const Matrix exact = problem.block_C(problem.deformed_point(step.x), initial, Vector::Zero(step.x.size()));
  EXPECT_LE(relative(problem.regularizer_gauss_newton(initial), exact), 1e-12);
  // Elsewhere it is JᵀCJ of the scaled residuals, by differences.
  const auto residuals = [&](const Vector& q) {
    const RestPoint at = problem.rest_point(q, false);
    Vector all(at.S[0].size() + at.S[1].size());
    for (int f = 0, row = 0; f < 2; row += static_cast<int>(at.S[f].size()), ++f) {
      all.segment(row, at.S[f].size()) =
          step.body.regularizer_coefficients[f].cwiseSqrt().cwiseProduct(at.S[f] - step.body.S0[f]);
    }
    return all;
  };
  const Matrix J = differences(residuals, step.q, 1e-6);
  const Matrix gauss_newton =
      J.transpose() * J + step.body.rate_weight * Matrix::Identity(step.q.size(), step.q.size());
  EXPECT_LE(relative(problem.regularizer_gauss_newton(rest), gauss_newton), 1e-8);
}

TEST(Regularizer, ScalesTheMaterial) {
  BodyInput input = box_input(small_box(), {.regularizer = "{stiffness: 0.5, volume_stiffness: 0.25}"});
  const BodyModel body = make_body_model(input, {});
  EXPECT_LE(relative(body.regularizer_coefficients[0], 0.5 * body.elastic[0]->coefficients()), 1e-15);
  EXPECT_LE(relative(body.regularizer_coefficients[1], 0.25 * body.elastic[1]->coefficients()), 1e-15);
}

TEST(StepProblem, InertiaAndGravityGiveImplicitEuler) {
  // Without deformation and contact, c = M (x − x̃) / h².
  const BodyModel body = make_body_model(box_input(small_box()), {});
  const ContactSet none;
  const Goals no_goals = make_goals({}, flat(small_box().V), 0.01);
  CounterRng rng(2);
  const Vector x_tilde = flat(small_box().V) + Vector::Constant(flat(small_box().V).size(), 0.3);
  const StepProblem problem(body, none, no_goals, x_tilde, x_tilde,
                            Vector::Zero(body.rest->free_parameters()), 0.01);
  const Vector c = problem.residual(problem.deformed_point(flat(small_box().V)),
                                    problem.rest_point(Vector::Zero(body.rest->free_parameters()), false));
  for (Eigen::Index i = 0; i < body.mass.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(c[3 * i + axis], -0.3 * body.mass[i] / 1e-4, 1e-9);
  }
  EXPECT_NEAR(body.mass.sum(), 300 * 0.4 * 0.5 * 0.45, 1e-9);
  EXPECT_NEAR(body.weight, body.mass.sum() * 9.81, 1e-9);
}

}  // namespace
}  // namespace vivify::sim
