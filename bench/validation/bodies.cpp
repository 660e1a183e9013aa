#include "bench/validation/bodies.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "bench/validation/lattice.h"
#include "common/error.h"
#include "common/rng.h"
#include "sim/control/controller.h"
#include "sim/settings.h"

namespace vivify::validation {

using namespace sim;

Value settings(const Schema& schema, const std::string& yaml) {
  std::vector<Error> errors;
  Value value = resolve(schema, parse_yaml(yaml, "validation", errors), errors);
  if (!errors.empty()) throw errors.front();
  return value;
}

BodyInput body_input(const SimMesh& mesh, const std::string& model, const std::string& rest_space) {
  BodyInput input;
  input.name = "body";
  input.rest = mesh;
  input.rest_space = rest_space;
  input.model = settings(model_schema(), model);
  input.regularizer = settings(regularizer_schema(), "{}");
  input.contact = settings(contact_schema(), "{}");
  input.controller = settings(controller_schema(), "{}");
  input.solver = settings(solver_schema(), "{}");
  return input;
}

// Strains without examples: the one rest space without parameters.
BodyModel body(const SimMesh& mesh, const std::string& model) {
  return make_body_model(body_input(mesh, model, "strains"), {});
}

std::vector<Sample> samples() {
  const auto curved = [](SimMesh mesh) {
    for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) mesh.V(i, 1) += 0.3 * std::pow(mesh.V(i, 0), 2);
    return mesh;
  };
  return {
      {"rod2d", curved(roughened(chain(8, 0, 1), 0.1, 1)), "{type: rod2d}"},
      {"solid2d", roughened(rectangle(4, 2, 1, 0.5), 0.1, 2), "{type: solid2d}"},
      {"solid2d_printed", roughened(rectangle(4, 2, 1, 0.5), 0.1, 3), "{type: solid2d_printed}"},
      {"shell3d", curved(roughened(equilateral_strip(2, 0.5, 0, 1), 0.1, 4)), "{type: shell3d}"},
      {"solid3d", roughened(box(3, 2, 2, 0.8, 0.5, 0.5), 0.1, 5), "{type: solid3d}"},
      {"solid3d_stvk", roughened(box(3, 2, 2, 0.8, 0.5, 0.5), 0.1, 6), "{type: solid3d_stvk}"},
  };
}

double energy(const BodyModel& body, const std::vector<Vector>& S, const Vector& x) {
  double sum = 0;
  Vector s;
  for (std::size_t f = 0; f < body.elastic.size(); ++f) {
    const MeasureFamily& family = *body.elastic[f];
    family.values(Side::deformed, x, s);
    sum += family.law().energy({family.coefficients(), s, S[f]});
  }
  return sum;
}

Vector gradient(const BodyModel& body, const std::vector<Vector>& S, const Vector& x) {
  Vector sum = Vector::Zero(x.size()), s, g;
  for (std::size_t f = 0; f < body.elastic.size(); ++f) {
    const MeasureFamily& family = *body.elastic[f];
    family.gradients(Side::deformed, x, s, g);
    family.scatter(Side::deformed, g, family.law().stress({family.coefficients(), s, S[f]}), sum);
  }
  return sum;
}

void stiffness(const BodyModel& body, const std::vector<Vector>& S, const Vector& x, SymmetricMatrix& D) {
  D.set_zero();
  Vector s, g;
  for (std::size_t f = 0; f < body.elastic.size(); ++f) {
    const MeasureFamily& family = *body.elastic[f];
    family.gradients(Side::deformed, x, s, g);
    const MeasureValues at = {family.coefficients(), s, S[f]};
    family.add_hessians(x, g, family.law().stiffness(at), family.law().stress(at), D);
  }
}

void hold(const std::vector<bool>& held, int dimension, double diagonal, SymmetricMatrix& D) {
  for (Eigen::Index column = 0; column < D.lower().outerSize(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(D.lower(), column); it; ++it) {
      if (held[static_cast<std::size_t>(it.row() / dimension)] ||
          held[static_cast<std::size_t>(column / dimension)]) {
        it.valueRef() = it.row() == column ? diagonal : 0;
      }
    }
  }
}

Vector equilibrium(const BodyModel& body, const Vector& x, const Vector& force, const std::vector<bool>& held,
                   double tolerance) {
  const StaticProblem problem{body.elastic, *body.pattern, body.S0, force, held};
  SymmetricMatrix D(*body.pattern);
  stiffness(body, body.S0, x, D);
  const double stiffest = D.lower().diagonal().cwiseAbs().maxCoeff(), extent = x.cwiseAbs().maxCoeff();
  const double rounding = std::numeric_limits<double>::epsilon() * stiffest * extent;
  const StaticSolution solution = solve_static(problem, x, std::max(tolerance * force.lpNorm<1>(), rounding));
  if (!solution.converged) {
    throw Error(ErrorKind::numerical, "the equilibrium of a " + body.name + " was not found: force " +
                                          std::to_string(solution.residual) + " N after " +
                                          std::to_string(solution.iterations) + " iterations");
  }
  return solution.x;
}

double lowest_frequency(const BodyModel& body, const std::vector<bool>& held) {
  const int d = body.dimension();
  SymmetricMatrix K(*body.pattern);
  stiffness(body, body.S0, flat(body.mesh.V), K);
  hold(held, d, 1, K);
  LinearSolver solver(*body.pattern);
  if (!solver.factorize(K)) throw Error(ErrorKind::numerical, "the body is not held");
  Vector mass(body.dofs());
  for (int i = 0; i < body.dofs(); ++i)
    mass[i] = held[static_cast<std::size_t>(i / d)] ? 0 : body.mass[i / d];
  CounterRng rng(1);
  Vector mode(body.dofs());
  for (double& value : mode) value = rng.uniform(-1, 1);
  double omega2 = 0;
  for (int i = 0; i < 60; ++i) {
    const Vector next = solver.solve(mass.cwiseProduct(mode));
    omega2 = next.dot(mass.cwiseProduct(mode)) / next.dot(mass.cwiseProduct(next));
    mode = next / next.norm();
  }
  return std::sqrt(omega2);
}

Resultant resultant(const Vector& x, const Vector& forces, int dimension) {
  Resultant sum{Vector::Zero(dimension), Vector::Zero(dimension == 2 ? 1 : 3)};
  for (Eigen::Index i = 0; i < x.size(); i += dimension) {
    const auto arm = x.segment(i, dimension);
    const auto force = forces.segment(i, dimension);
    sum.force += force;
    if (dimension == 2) {
      sum.torque[0] += arm[0] * force[1] - arm[1] * force[0];
    } else {
      sum.torque += Eigen::Vector3d(arm).cross(Eigen::Vector3d(force));
    }
  }
  return sum;
}

}  // namespace vivify::validation
