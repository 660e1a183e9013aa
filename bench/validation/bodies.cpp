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

std::vector<Sample> samples(const std::string& keys) {
  const auto curved = [](SimMesh mesh) {
    for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) mesh.V(i, 1) += 0.3 * std::pow(mesh.V(i, 0), 2);
    return mesh;
  };
  std::vector<Sample> list = {
      {"rod2d", curved(roughened(chain(8, 0, 1), 0.1, 1)), {}},
      {"solid2d", roughened(rectangle(4, 2, 1, 0.5), 0.1, 2), {}},
      {"solid2d_printed", roughened(rectangle(4, 2, 1, 0.5), 0.1, 3), {}},
      {"shell3d", curved(roughened(equilateral_strip(2, 0.5, 0, 1), 0.1, 4)), {}},
      {"solid3d", roughened(box(3, 2, 2, 0.8, 0.5, 0.5), 0.1, 5), {}},
      {"solid3d_stvk", roughened(box(3, 2, 2, 0.8, 0.5, 0.5), 0.1, 6), {}},
  };
  for (Sample& sample : list) sample.yaml = "{type: " + sample.model + keys + "}";
  return list;
}

RowMatrixXd bent_pose(const SimMesh& mesh, double curvature) {
  RowMatrixXd V = mesh.V;
  for (Eigen::Index i = 0; i < V.rows(); ++i) {
    const double t = curvature * V(i, 0), r = 1 / curvature + V(i, 1);
    V(i, 0) = r * std::sin(t) + 0.05 * V(i, 1);
    V(i, 1) = r * std::cos(t) - 1 / curvature;
  }
  return V;
}

BodyInput sample_input(const Sample& sample, const std::string& rest_space) {
  BodyInput input = body_input(sample.mesh, sample.yaml, rest_space);
  const RowMatrixXd& V = sample.mesh.V;
  if (rest_space == "examples" || rest_space == "strains") {
    input.examples = {{"left", "a", bent_pose(sample.mesh, 0.6)},
                      {"right", "a", bent_pose(sample.mesh, -0.5)}};
  }
  if (rest_space == "cage") {
    const Eigen::RowVectorXd low = V.colwise().minCoeff(), size = V.colwise().maxCoeff() - low;
    input.cage_weights.setOnes(V.rows(), 1 << V.cols());
    for (Eigen::Index i = 0; i < V.rows(); ++i) {
      for (int c = 0; c < input.cage_weights.cols(); ++c) {
        for (Eigen::Index k = 0; k < V.cols(); ++k) {
          const double t = (V(i, k) - low[k]) / size[k];
          input.cage_weights(i, c) *= (c >> k & 1) != 0 ? t : 1 - t;
        }
      }
    }
  }
  return input;
}

BodyModel sample_body(const Sample& sample, const std::string& rest_space) {
  return make_body_model(sample_input(sample, rest_space), {});
}

Vector random_vector(Eigen::Index size, double reach, CounterRng& rng) {
  Vector v(size);
  for (double& value : v) value = rng.uniform(-reach, reach);
  return v;
}

StepState::StepState(const Sample& sample, const std::string& rest_space, std::uint64_t seed)
    : body(sample_body(sample, rest_space)) {
  CounterRng rng(seed);
  const double h = 1.0 / 48;
  const Vector X = flat(body.mesh.V), x_n = X + random_vector(X.size(), 0.01, rng);
  x = x_n + random_vector(X.size(), 0.01, rng);
  const double reach = body.rest->unit() == 1 ? 0.3 : 0.01;
  q = random_vector(body.rest->free_parameters(), reach, rng);
  std::vector<Goal> wanted;
  for (int i = 0; i < 3; ++i) {
    const double weight = std::sqrt(10 * body.mass.sum());
    wanted.push_back({random_vector(X.size(), 1, rng), 0, weight, 0, rng.uniform(-1, 1)});
  }
  goals = make_goals(wanted, x_n, h);
  problem =
      std::make_unique<StepProblem>(body, contacts, goals, x_n, x_n + random_vector(X.size(), 0.01, rng),
                                    q + random_vector(q.size(), reach / 3, rng), h);
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

Motion::Motion(const BodyModel& body, Vector x, Vector v, double h, double gravity)
    : body_(body),
      workspace_(*body.pattern),
      x_(std::move(x)),
      v_(std::move(v)),
      forces_(Vector::Zero(x_.size())),
      h_(h),
      gravity_(gravity) {}

void Motion::step(const Vector& q) {
  Vector x_tilde = x_ + h_ * v_;
  for (Eigen::Index i = 1; i < x_.size(); i += body_.dimension()) x_tilde[i] -= h_ * h_ * gravity_;
  const ContactSet none;
  const Goals goals = make_goals({}, x_, h_);
  const StepProblem problem(body_, none, goals, x_, x_tilde, q, h_);
  const RestPoint rest = problem.rest_point(q, false);
  const double rounding = 4 * std::numeric_limits<double>::epsilon() * body_.mass.maxCoeff() / (h_ * h_) *
                          x_.cwiseAbs().maxCoeff() / body_.weight;
  const ForwardResult end =
      forward_step(problem, rest, x_ + h_ * v_, std::max(kFinishTolerance, rounding), workspace_);
  if (!end.converged) throw Error(ErrorKind::numerical, "a step of the motion was not solved");
  forces_ = -problem.internal_gradient(0, end.at, rest);
  v_ = (end.at.x - x_) / h_;
  x_ = end.at.x;
}

double Motion::kinetic_energy() const { return 0.5 * coordinate_masses(body_).dot(v_.cwiseAbs2()); }

Vector coordinate_masses(const BodyModel& body) {
  return body.mass.transpose().replicate(body.dimension(), 1).reshaped();
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
