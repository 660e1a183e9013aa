#include "tests/sim/fixtures.h"

#include <unistd.h>

#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <set>

#include "sim/settings.h"

namespace vivify::sim {

TetMesh box_mesh(const Eigen::Vector3i& cells, const Eigen::Vector3d& size, const Eigen::Vector3d& corner) {
  static constexpr std::array<std::array<int, 4>, 5> kTets = {
      {{0, 3, 5, 6}, {1, 0, 3, 5}, {2, 0, 3, 6}, {4, 0, 5, 6}, {7, 3, 5, 6}}};
  const Eigen::Vector3i nodes = cells.array() + 1;
  const auto index = [&](int i, int j, int k) { return i + nodes.x() * (j + nodes.y() * k); };
  TetMesh mesh;
  mesh.V.resize(nodes.prod(), 3);
  for (int k = 0; k < nodes.z(); ++k) {
    for (int j = 0; j < nodes.y(); ++j) {
      for (int i = 0; i < nodes.x(); ++i) {
        const Eigen::Vector3d share = Eigen::Vector3d(i, j, k).cwiseQuotient(cells.cast<double>());
        mesh.V.row(index(i, j, k)) = (corner + size.cwiseProduct(share)).transpose();
      }
    }
  }
  mesh.T.resize(5 * cells.prod(), 4);
  int t = 0;
  for (int k = 0; k < cells.z(); ++k) {
    for (int j = 0; j < cells.y(); ++j) {
      for (int i = 0; i < cells.x(); ++i) {
        const int mirror = (i + j + k) % 2 == 0 ? 0 : 7;
        for (const auto& tet : kTets) {
          for (int c = 0; c < 4; ++c) {
            const int bits = tet[c] ^ mirror;
            mesh.T(t, c) = index(i + (bits & 1), j + (bits >> 1 & 1), k + (bits >> 2));
          }
          const auto edge = [&](int c) -> Eigen::Vector3d {
            return (mesh.V.row(mesh.T(t, c)) - mesh.V.row(mesh.T(t, 0))).transpose();
          };
          if (edge(1).dot(edge(2).cross(edge(3))) < 0) std::swap(mesh.T(t, 2), mesh.T(t, 3));
          ++t;
        }
      }
    }
  }
  return mesh;
}

Matrix trilinear_weights(const Points& V) {
  const Box box = bounding_box(V);
  const Eigen::Vector3d margin = 0.1 * (box.max - box.min), low = box.min - margin,
                        size = box.max + margin - low;
  Matrix weights(V.rows(), 8);
  for (Eigen::Index i = 0; i < V.rows(); ++i) {
    const Eigen::Vector3d t = (V.row(i).transpose() - low).cwiseQuotient(size);
    for (int c = 0; c < 8; ++c) {
      weights(i, c) = (c & 1 ? t.x() : 1 - t.x()) * (c & 2 ? t.y() : 1 - t.y()) * (c & 4 ? t.z() : 1 - t.z());
    }
  }
  return weights;
}

namespace {

ContactPoints contact_points(const std::vector<std::array<int, 4>>& vertices,
                             const std::vector<std::array<double, 4>>& weights) {
  ContactPoints points;
  points.vertices.resize(static_cast<Eigen::Index>(vertices.size()), 4);
  points.weights.resize(static_cast<Eigen::Index>(vertices.size()), 4);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    for (int k = 0; k < 4; ++k) {
      points.vertices(static_cast<Eigen::Index>(i), k) = vertices[i][k];
      points.weights(static_cast<Eigen::Index>(i), k) = weights[i][k];
    }
  }
  return points;
}

}  // namespace

ContactPoints vertex_contacts(const TetMesh& mesh) {
  const Triangles faces = boundary_faces(mesh);
  const std::set<int> boundary(faces.data(), faces.data() + faces.size());
  std::vector<std::array<int, 4>> vertices;
  for (const int v : boundary) {
    for (int t = 0; t < mesh.T.rows(); ++t) {
      std::array<int, 4> corners = {mesh.T(t, 0), mesh.T(t, 1), mesh.T(t, 2), mesh.T(t, 3)};
      const auto found = std::find(corners.begin(), corners.end(), v);
      if (found == corners.end()) continue;
      std::swap(corners[0], *found);
      vertices.push_back(corners);
      break;
    }
  }
  return contact_points(vertices, std::vector<std::array<double, 4>>(vertices.size(), {1, 0, 0, 0}));
}

ContactPoints fractional_contacts(const TetMesh& mesh, std::uint64_t seed) {
  CounterRng rng(seed);
  const Triangles faces = boundary_faces(mesh);
  std::vector<std::array<int, 4>> vertices;
  std::vector<std::array<double, 4>> weights;
  for (int f = 0; f < faces.rows(); ++f) {
    for (int t = 0; t < mesh.T.rows(); ++t) {
      std::array<int, 4> corners = {faces(f, 0), faces(f, 1), faces(f, 2), -1};
      int shared = 0;
      for (int k = 0; k < 4; ++k) {
        const int v = mesh.T(t, k);
        if (std::find(corners.begin(), corners.begin() + 3, v) != corners.begin() + 3) {
          ++shared;
        } else {
          corners[3] = v;
        }
      }
      if (shared < 3) continue;
      const double a = rng.uniform(0.2, 0.4), b = rng.uniform(0.2, 0.4), inner = rng.uniform(0.002, 0.01);
      vertices.push_back(corners);
      weights.push_back({a, b, 1 - a - b - inner, inner});
      break;
    }
  }
  return contact_points(vertices, weights);
}

ContactPoints join(const ContactPoints& a, const ContactPoints& b) {
  ContactPoints both;
  both.vertices.resize(a.size() + b.size(), 4);
  both.weights.resize(a.size() + b.size(), 4);
  both.vertices << a.vertices, b.vertices;
  both.weights << a.weights, b.weights;
  return both;
}

Value settings(const Schema& schema, const std::string& yaml) {
  std::vector<Error> errors;
  Value value = resolve(schema, parse_yaml(yaml, "test", errors), errors);
  if (!errors.empty()) throw errors.front();
  return value;
}

BodyInput box_input(const TetMesh& mesh, const Scene& scene) {
  return {"box",
          sim_mesh(mesh),
          "cage",
          trilinear_weights(mesh.V),
          {},
          vertex_contacts(mesh),
          settings(model_schema(), scene.model),
          settings(regularizer_schema(), scene.regularizer),
          settings(contact_schema(), scene.contact),
          settings(controller_schema(), scene.controller),
          settings(solver_schema(), scene.solver)};
}

TetMesh standing_box() { return box_mesh({3, 5, 4}, {0.8, 1, 0.8}, {-0.4, 0, -0.4}); }
TetMesh small_box() { return box_mesh({2, 2, 2}, {0.4, 0.5, 0.45}, {-0.2, 0, -0.2}); }

Collider plane(double friction, const Eigen::Vector3d& normal, const Eigen::Vector3d& point) {
  const Eigen::Matrix3d R =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitY(), normal).toRotationMatrix();
  TriangleMesh square;
  square.V.resize(4, 3);
  square.V << -50, 0, -50, -50, 0, 50, 50, 0, 50, 50, 0, -50;
  square.V = (square.V * R.transpose()).eval();
  square.V.rowwise() += point.transpose();
  square.F.resize(2, 3);
  square.F << 0, 1, 2, 0, 2, 3;
  return Collider("plane", square, friction);
}

std::vector<Collider> one(Collider collider) {
  std::vector<Collider> colliders;
  colliders.push_back(std::move(collider));
  return colliders;
}

void set_motion(World& world, const Vector& x, const Vector& v) {
  const Body& body = world.body(0);
  const std::string group = "/bodies/" + body.model().name;
  const auto path =
      std::filesystem::temp_directory_path() / ("vivify_sim_tests_" + std::to_string(getpid()) + ".h5");
  // The state of a world that has not moved yet, with other positions and velocities.
  Hdf5Writer still;
  world.save(still);
  still.save(path);
  {
    Hdf5Reader reader(path);
    Hdf5Writer moving;
    moving.put("/step", reader.integer("/step"));
    moving.put(group + "/x", RowMatrixXd(rows(x)));
    moving.put(group + "/v", RowMatrixXd(rows(v)));
    moving.put(group + "/restart/q", reader.vector(group + "/restart/q"));
    moving.put(group + "/restart/contact", reader.matrix(group + "/restart/contact"));
    moving.put(group + "/restart/controller", reader.vector(group + "/restart/controller"));
    moving.save(path);
  }
  world.restore(Hdf5Reader(path));
  std::filesystem::remove(path);
}

Vector flat(const Points& V) { return Eigen::Map<const Vector>(V.data(), V.size()); }
Points rows(const Vector& x) { return Eigen::Map<const Points>(x.data(), x.size() / 3, 3); }

Vector random_vector(Eigen::Index size, double scale, CounterRng& rng) {
  Vector v(size);
  for (Eigen::Index i = 0; i < size; ++i) v[i] = rng.uniform(-scale, scale);
  return v;
}

Eigen::Matrix3d random_rotation(CounterRng& rng) {
  const Eigen::Vector3d axis = random_vector(3, 1, rng);
  return Eigen::AngleAxisd(rng.uniform(0.5, 3), axis.normalized()).toRotationMatrix();
}

Vector rigid(const Eigen::Matrix3d& R, const Eigen::Vector3d& b, const Vector& x) {
  Vector y(x.size());
  for (Eigen::Index i = 0; i < x.size(); i += 3) y.segment<3>(i) = R * x.segment<3>(i) + b;
  return y;
}

Matrix dense(const SymmetricMatrix& matrix) {
  return matrix * Matrix::Identity(matrix.lower().rows(), matrix.lower().rows());
}

Matrix differences(const Function& f, const Vector& x, double eps) {
  Matrix J;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    Vector plus = x, minus = x;
    plus[i] += eps;
    minus[i] -= eps;
    const Vector column = (f(plus) - f(minus)) / (plus[i] - minus[i]);
    if (i == 0) J.resize(column.size(), x.size());
    J.col(i) = column;
  }
  return J;
}

double relative(const Matrix& a, const Matrix& b) { return (a - b).norm() / b.norm(); }

double convergence(const Function& f, const Vector& x, const Vector& d, const Vector& exact, double eps) {
  const auto error = [&](double step) {
    return ((f(x + step * d) - f(x - step * d)) / (2 * step) - exact).norm();
  };
  return error(2 * eps) / error(eps);
}

RandomStep::RandomStep(std::uint64_t seed, double friction, double noise) {
  CounterRng rng(seed);
  const WorldSettings world;
  const Eigen::Matrix3d tilt = random_rotation(rng);
  TetMesh mesh = small_box();
  const Vector straight = flat(mesh.V);
  mesh.V = rows(rigid(tilt, {0, 0, 0}, straight));
  BodyInput input =
      box_input(mesh, {.model = "{type: solid3d, density: 300, stiffness: 88000, volume_stiffness: 88000}",
                       .regularizer = "{stiffness: 0.03, volume_stiffness: 0.03, rate: 0.03}"});
  input.contact_points = join(vertex_contacts(mesh), fractional_contacts(mesh, seed));
  body = make_body_model(input, world);
  const double layer = 0.02;
  const double point_weight = body.weight / 10;
  const ContactParameters parameters = {layer, point_weight / (layer * layer), 2 * point_weight / layer};

  // Sheared and noisy, the lowest layer of vertices near the plane y = 0, then all tilted.
  Vector lying = straight + random_vector(straight.size(), noise, rng);
  for (Eigen::Index i = 0; i < lying.size(); i += 3) {
    if (straight[i + 1] == 0) {
      lying[i + 1] = layer * (rng.uniform() < 0.75 ? rng.uniform(0.1, 0.85) : rng.uniform(1.15, 2));
    } else {
      lying[i] += 0.1 * straight[i + 1];
      lying[i + 1] -= 0.05 * straight[i + 1];
    }
  }
  x = rigid(tilt, {0, 0, 0}, lying);
  q = random_vector(body.rest->free_parameters(), 0.02, rng);
  const Vector q_n = q + random_vector(q.size(), 0.01, rng);
  const Vector x_tilde = x + random_vector(x.size(), 0.005, rng);

  // What the points remember: every third one has just arrived, the others are 0.3 or 1.7 slip limits from
  // their anchors (with unlimited friction: as far, of the limit for μ = 1).
  colliders = one(plane(friction, tilt.col(1)));
  std::vector<ContactMemory> memory(static_cast<std::size_t>(body.contact_points.size()));
  for (int i = 0; i < body.contact_points.size(); ++i) {
    if (i % 3 == 2) continue;
    ContactMemory& point = memory[static_cast<std::size_t>(i)];
    point.touching = true;
    point.collider = 0;
    point.normal_force = point_weight * rng.uniform(0.5, 1.5);
    const double limit =
        Friction(parameters.friction_stiffness, (std::isinf(friction) ? 1 : friction) * point.normal_force)
            .slip_limit();
    const double angle = rng.uniform(0, 6.28);
    const Eigen::Vector3d direction =
        tilt * Eigen::Vector3d(std::cos(angle), rng.uniform(-0.5, 0.5), std::sin(angle));
    point.anchor = body.contact_points.position(i, x) - (i % 3 == 0 ? 0.3 : 1.7) * limit * direction;
  }
  contacts = ContactSet(body.contact_points, parameters, colliders, x, 0.1, memory);
  for (const Contact& contact : contacts.contacts()) {
    const double d = contacts.distance(contact, x);
    (d < layer ? pressing : above) += 1;
    room = std::min(room, std::abs(d - layer));
    if (contact.point % 3 == 2) continue;
    const Eigen::Vector3d offset = body.contact_points.position(contact.point, x) - contact.anchor;
    const double slip = (offset - contact.normal * contact.normal.dot(offset)).norm();
    const double limit = contact.friction.slip_limit();
    (slip < limit ? sticking : slipping) += 1;
    room = std::min({room, slip, std::abs(slip - limit)});
  }

  std::vector<Goal> wanted;
  for (int axis = 0; axis < 3; ++axis) {
    const double kd = std::sqrt(body.mass.sum());
    wanted.push_back({centre_of_mass_weights(body.mass, Eigen::Vector3d::Unit(axis)), 2 * kd, kd,
                      rng.uniform(-0.2, 0.2), rng.uniform(-1, 1)});
    wanted.push_back(
        {spin_weights(body.mass, x_tilde, Eigen::Vector3d::Unit(axis)), 0, 0.3 * kd, 0, rng.uniform(-1, 1)});
  }
  goals = make_goals(wanted, x_tilde, world.h);
  problem = std::make_unique<StepProblem>(body, contacts, goals, x, x_tilde, q_n, world.h);
  workspace = std::make_unique<StepWorkspace>(*body.pattern);
}

}  // namespace vivify::sim
