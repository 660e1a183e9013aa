#include "bench/ipopt/step_case.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <set>

#include "bench/validation/bodies.h"
#include "bench/validation/lattice.h"
#include "sim/control/rigid_motion.h"

namespace vivify::ipopt {

using namespace sim;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using validation::random_vector;

namespace {

int random_int(CounterRng& rng, int low, int high) {
  return low + static_cast<int>(rng.uniform(0, high - low + 1));
}

// About 1 m long.
SimMesh random_mesh(const StepCase& of, CounterRng& rng) {
  SimMesh mesh;
  if (of.model == "rod2d") {
    mesh = validation::chain(random_int(rng, 12, 40), -0.5, 0.5);
    if (of.closed) {
      const Eigen::Index n = mesh.V.rows();
      for (Eigen::Index i = 0; i < n; ++i) {
        const double t = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
        mesh.V.row(i) << 0.4 * std::cos(t), 0.3 * std::sin(t);
      }
      mesh.E.conservativeResize(n, 2);
      mesh.E.row(n - 1) << static_cast<int>(n) - 1, 0;
    }
  } else if (of.model.starts_with("solid2d")) {
    mesh = validation::rectangle(random_int(rng, 4, 8), random_int(rng, 2, 4), 1, 0.5);
  } else if (of.model.starts_with("shell")) {
    mesh = validation::equilateral_strip(random_int(rng, 2, 3), 0.5, -0.5, 0.5);
  } else {
    mesh = validation::box(random_int(rng, 2, 3), random_int(rng, 1, 2), 2, 0.9, 0.5, 0.5);
  }
  mesh = validation::roughened(std::move(mesh), 0.15, rng.next());
  const double curvature = rng.uniform(0.2, 0.5);
  if (!of.closed) {
    for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) mesh.V(i, 1) += curvature * std::pow(mesh.V(i, 0), 2);
  }
  return mesh;
}

// A random rotation; of the plane in two dimensions.
MatrixXd random_rotation(int dimension, CounterRng& rng) {
  const double angle = rng.uniform(0, 2 * std::numbers::pi);
  if (dimension == 2) return Eigen::Rotation2Dd(angle).toRotationMatrix();
  const Vector3d axis = random_vector(3, 1, rng).normalized();
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

// Every vertex, as a point of an element of its own.
ContactPoints vertex_points(const SimMesh& mesh) {
  std::set<int> seen;
  ContactPoints points;
  points.dimension = mesh.dimension();
  points.vertices.resize(mesh.V.rows(), mesh.E.cols());
  points.weights.setZero(mesh.V.rows(), mesh.E.cols());
  Eigen::Index count = 0;
  for (Eigen::Index e = 0; e < mesh.E.rows(); ++e) {
    for (Eigen::Index k = 0; k < mesh.E.cols(); ++k) {
      if (!seen.insert(mesh.E(e, k)).second) continue;
      points.vertices.row(count) = mesh.E.row(e);
      points.weights(count++, k) = 1;
    }
  }
  return points;
}

// Multilinear coordinates in a box a little larger than the body.
MatrixXd box_weights(const RowMatrixXd& V) {
  const Eigen::RowVectorXd low = V.colwise().minCoeff(), size = V.colwise().maxCoeff() - low;
  MatrixXd weights = MatrixXd::Ones(V.rows(), Eigen::Index(1) << V.cols());
  for (Eigen::Index i = 0; i < V.rows(); ++i) {
    for (Eigen::Index corner = 0; corner < weights.cols(); ++corner) {
      for (Eigen::Index axis = 0; axis < V.cols(); ++axis) {
        const double t = (V(i, axis) - low[axis] + 0.1 * size[axis]) / (1.2 * size[axis]);
        weights(i, corner) *= (corner >> axis & 1) != 0 ? t : 1 - t;
      }
    }
  }
  return weights;
}

Collider ground(double friction) {
  TriangleMesh square;
  square.V.resize(4, 3);
  square.V << -50, 0, -50, -50, 0, 50, 50, 0, 50, 50, 0, -50;
  square.F.resize(2, 3);
  square.F << 0, 1, 2, 0, 2, 3;
  return Collider("ground", square, friction);
}

}  // namespace

std::string StepCase::name() const {
  return model + (closed ? "_ring_" : "_") + rest_space + (ground ? "_ground" : "") +
         (damped ? "_damped" : "") + "_" + std::to_string(seed);
}

const std::vector<StepCase>& step_cases() {
  static const std::vector<StepCase> cases = [] {
    std::vector<StepCase> list;
    const auto add = [&list](const char* model, const char* space, bool closed) {
      const std::size_t i = list.size();
      list.push_back({model, space, closed, i % 2 == 1, i % 3 == 2, 100 + i});
    };
    for (const char* model : {"rod2d", "solid2d", "solid2d_printed", "shell3d", "solid3d", "solid3d_stvk"}) {
      for (const char* space : {"cage", "examples", "full"}) add(model, space, false);
    }
    add("rod2d", "examples", true);
    add("rod2d", "full", true);
    return list;
  }();
  return cases;
}

Step::Step(const StepCase& of) {
  CounterRng rng(of.seed);
  const WorldSettings world;
  SimMesh mesh = random_mesh(of, rng);
  const int d = mesh.dimension();
  const MatrixXd turn = random_rotation(d, rng);
  const auto turned = [&](const RowMatrixXd& V) -> RowMatrixXd { return V * turn.transpose(); };

  BodyInput input = validation::body_input(
      {turned(mesh.V), mesh.E}, "{type: " + of.model + (of.damped ? ", damping_s: 0.02" : "") + "}",
      of.rest_space);
  input.cage_weights = box_weights(input.rest.V);
  input.examples = {{"left", "a", turned(validation::bent_pose(mesh, rng.uniform(0.4, 0.8)))},
                    {"right", "a", turned(validation::bent_pose(mesh, rng.uniform(-0.8, -0.4)))}};
  input.contact_points = vertex_points(input.rest);
  body = make_body_model(input, world);

  // Bent and stretched a few percent, twisted by a linear field and a little rough.
  const VectorXd X = validation::flat(body.mesh.V);
  const MatrixXd field = random_vector(d * d, 0.03, rng).reshaped(d, d);
  VectorXd x_n = (X.reshaped(d, X.size() / d) + field * X.reshaped(d, X.size() / d)).reshaped();
  x_n += random_vector(X.size(), 0.05 * validation::shortest_edge(body.mesh), rng);
  const double pace = of.ground ? 0.3 : 1;  // on the ground most points stick
  const Vector3d spin =
      pace * (d == 3 ? Vector3d(random_vector(3, 1.5, rng)) : Vector3d(0, 0, rng.uniform(-2, 2)));
  const Vector3d throwing = pace * random_vector(3, 0.5, rng);
  const Vector3d centre = centre_of_mass(body.mass, x_n);
  VectorXd v_n(X.size());
  for (Eigen::Index i = 0; i < body.mass.size(); ++i) {
    const Vector3d v = throwing + spin.cross(spatial_point(x_n, i, d) - centre);
    for (int axis = 0; axis < d; ++axis) v_n[d * i + axis] = v[axis];
  }

  // The lowest points press on the ground; those near it touched before, near their anchors.
  std::vector<ContactMemory> memory(static_cast<std::size_t>(body.contact_points.size()));
  if (of.ground) {
    const double layer = body.contact.layer, shift = 0.3 * layer - lowest_height(x_n, d);
    for (Eigen::Index i = 1; i < x_n.size(); i += d) x_n[i] += shift;
    colliders.push_back(ground(rng.uniform(0.3, 1)));
    for (int i = 0; i < body.contact_points.size(); ++i) {
      const Vector3d place = body.contact_points.position(i, x_n);
      if (place.y() >= layer) continue;
      Vector3d slip = 0.2 * layer * random_vector(3, 1, rng);
      slip.y() = 0;
      if (d == 2) slip.z() = 0;
      memory[static_cast<std::size_t>(i)] = {true, place - slip, 0.5 * body.weight * rng.uniform(0.5, 1), 0};
    }
    contacts = ContactSet(body.contact_points, body.contact, colliders, x_n, 0.2 * body.height, memory);
  }

  const double h = world.h;
  VectorXd x_tilde = x_n + h * v_n;
  for (Eigen::Index i = 1; i < x_tilde.size(); i += d) x_tilde[i] += h * h * world.gravity.y();
  const double k = std::sqrt(body.mass.sum());
  std::vector<Goal> wanted;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d direction = Vector3d::Unit(axis);
    wanted.push_back({centre_of_mass_weights(body.mass, direction, d), 0, k, 0,
                      throwing[axis] + pace * rng.uniform(-0.4, 0.4)});
    wanted.push_back(
        {spin_weights(body.mass, x_n, direction), 0, 0.3 * k, 0, spin[axis] + pace * rng.uniform(-0.8, 0.8)});
  }
  goals = make_goals(wanted, x_n, h);
  x = x_tilde;
  const bool examples = !body.rest->groups().empty();
  q = random_vector(body.rest->free_parameters(), (examples ? 0.2 : 0.02) * body.rest->unit(), rng);
  if (examples) q.array() += 0.3 * body.rest->unit();
  problem = std::make_unique<StepProblem>(body, contacts, goals, x_n, x_tilde, q, h);
  workspace = std::make_unique<StepWorkspace>(*body.pattern);
}

}  // namespace vivify::ipopt
