#include "tests/sim/fixtures.h"

#include <unistd.h>

#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <numbers>
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

namespace {

RowMatrixXi index_rows(const std::vector<std::vector<int>>& rows_of) {
  RowMatrixXi E(static_cast<Eigen::Index>(rows_of.size()), static_cast<Eigen::Index>(rows_of.front().size()));
  for (Eigen::Index e = 0; e < E.rows(); ++e) {
    for (Eigen::Index k = 0; k < E.cols(); ++k) {
      E(e, k) = rows_of[static_cast<std::size_t>(e)][static_cast<std::size_t>(k)];
    }
  }
  return E;
}

NamedMesh rod(bool closed) {
  const int n = 7;
  NamedMesh rod{closed ? "ring" : "rod", {RowMatrixXd(n, 2), {}}};
  std::vector<std::vector<int>> edges;
  for (int i = 0; i < n; ++i) {
    const double t = closed ? 2 * std::numbers::pi * (i + 0.5 - n / 4.0) / n : i / (n - 1.0);
    if (closed) {
      rod.mesh.V.row(i) << 0.25 * std::cos(t), 0.25 + 0.25 * std::sin(t);
    } else {
      rod.mesh.V.row(i) << 0.6 * t - 0.3, 0.5 * std::pow(t - 0.3, 2);
    }
    if (closed || i + 1 < n) edges.push_back({i, (i + 1) % n});
  }
  rod.mesh.E = index_rows(edges);
  return rod;
}

// Three by three vertices over the unit square, with diagonals of either kind.
RowMatrixXi patch_triangles() {
  std::vector<std::vector<int>> triangles;
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      const int a = i + 3 * j, b = a + 1, c = a + 4, d = a + 3;
      if ((i + j) % 2 == 0) {
        triangles.push_back({a, b, c});
        triangles.push_back({a, c, d});
      } else {
        triangles.push_back({a, b, d});
        triangles.push_back({b, c, d});
      }
    }
  }
  return index_rows(triangles);
}

NamedMesh patch(int dimension) {
  NamedMesh patch{dimension == 2 ? "patch" : "arch", {RowMatrixXd(9, dimension), patch_triangles()}};
  for (int i = 0; i < 9; ++i) {
    const double u = 0.5 * (i % 3), v = 0.5 * (i / 3);  // NOLINT(bugprone-integer-division)
    if (dimension == 2) {
      patch.mesh.V.row(i) << 0.5 * u - 0.25, 0.5 * v;
    } else {
      patch.mesh.V.row(i) << 0.6 * u - 0.3, 1.2 * u * (1 - u) + 0.2 * u * v * v, 0.25 - 0.5 * v;
    }
  }
  return patch;
}

NamedMesh closed_shell() {
  return {
      "box",
      {(RowMatrixXd(8, 3) << -1, 0, -1, 1, 0, -1, -1, 2, -1, 1, 2, -1, -1, 0, 1, 1, 0, 1, -1, 2, 1, 1, 2, 1)
               .finished() *
           0.22,
       index_rows({{0, 2, 3},
                   {0, 3, 1},
                   {4, 5, 7},
                   {4, 7, 6},
                   {0, 4, 6},
                   {0, 6, 2},
                   {1, 3, 7},
                   {1, 7, 5},
                   {0, 1, 5},
                   {0, 5, 4},
                   {2, 6, 7},
                   {2, 7, 3}})}};
}

}  // namespace

std::vector<NamedMesh> small_meshes(int dimension, int element_points) {
  std::vector<NamedMesh> meshes;
  if (dimension == 2 && element_points == 2) meshes = {rod(false), rod(true)};
  if (dimension == 2 && element_points == 3) meshes = {patch(2)};
  if (dimension == 3 && element_points == 3) meshes = {patch(3), closed_shell()};
  if (element_points == 4) {
    meshes = {{"box", sim_mesh(box_mesh({2, 1, 1}, {0.5, 0.4, 0.3}, {-0.25, 0, -0.15}))}};
  }
  CounterRng rng(7);
  for (NamedMesh& named : meshes) {
    // Vertices on the ground stay there.
    for (Eigen::Index i = 0; i < named.mesh.V.rows(); ++i) {
      for (Eigen::Index axis = 0; axis < dimension; ++axis) {
        if (axis != 1 || named.mesh.V(i, 1) > 1e-9) named.mesh.V(i, axis) += rng.uniform(-0.015, 0.015);
      }
    }
  }
  return meshes;
}

std::vector<ExamplePose> smooth_poses(const SimMesh& mesh) {
  const int d = mesh.dimension();
  const Eigen::RowVectorXd low = mesh.V.colwise().minCoeff(), high = mesh.V.colwise().maxCoeff();
  const auto pose = [&](const char* name, const char* group, double angle, const auto& deform) {
    ExamplePose result{name, group, mesh.V};
    const double c = std::cos(angle), s = std::sin(angle);
    for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
      Eigen::Vector3d u = Eigen::Vector3d::Zero();  // the bounding box is [−1, 1]^d
      u.head(d) = ((2 * mesh.V.row(i) - low - high).array() / (high - low).array()).matrix().transpose();
      const Eigen::Vector3d y = deform(u);
      const Eigen::Vector3d turned(c * y.x() - s * y.y(), s * y.x() + c * y.y(), y.z());
      result.V.row(i) = 0.25 * turned.head(d).transpose();
    }
    return result;
  };
  using Point = Eigen::Vector3d;
  return {pose("bent", "a", 0.7,
               [](const Point& u) -> Point {
                 return {u.x() + 0.3 * u.y() * u.y(), u.y() - 0.2 * u.x() * u.x(), u.z()};
               }),
          pose("tall", "a", -2.5,
               [](const Point& u) -> Point {
                 return {0.8 * u.x() + 0.2 * u.y(), 1.3 * u.y(), 0.9 * u.z()};
               }),
          pose("twisted", "b", 1.2, [](const Point& u) -> Point {
            const double angle = 0.4 * u.y(), size = 1 + 0.2 * u.y();
            return {size * (std::cos(angle) * u.x() + std::sin(angle) * u.z()), u.y() + 0.1 * u.x(),
                    size * (std::cos(angle) * u.z() - std::sin(angle) * u.x())};
          })};
}

Matrix multilinear_weights(const RowMatrixXd& V) {
  const Eigen::Index d = V.cols(), corners = Eigen::Index(1) << d;
  const Eigen::RowVectorXd min = V.colwise().minCoeff(), max = V.colwise().maxCoeff();
  const Eigen::RowVectorXd margin = 0.1 * (max - min), low = min - margin, size = max + margin - low;
  Matrix weights = Matrix::Ones(V.rows(), corners);
  for (Eigen::Index i = 0; i < V.rows(); ++i) {
    const Eigen::RowVectorXd t = (V.row(i) - low).cwiseQuotient(size);
    for (Eigen::Index c = 0; c < corners; ++c) {
      for (Eigen::Index axis = 0; axis < d; ++axis) weights(i, c) *= c >> axis & 1 ? t[axis] : 1 - t[axis];
    }
  }
  return weights;
}

ContactPoints vertex_contacts(const SimMesh& mesh) {
  std::set<int> touching(mesh.E.data(), mesh.E.data() + mesh.E.size());
  if (mesh.element_points() == 4) {
    const Triangles faces = boundary_faces({mesh.V, mesh.E});
    touching = std::set<int>(faces.data(), faces.data() + faces.size());
  }
  const Eigen::Index count = static_cast<Eigen::Index>(touching.size());
  ContactPoints points{RowMatrixXi(count, mesh.E.cols()), RowMatrixXd::Zero(count, mesh.E.cols()),
                       mesh.dimension()};
  points.weights.col(0).setOnes();
  Eigen::Index i = 0;
  for (const int v : touching) {
    for (Eigen::Index e = 0; e < mesh.E.rows(); ++e) {
      Eigen::RowVectorXi corners = mesh.E.row(e);
      const auto found = std::find(corners.begin(), corners.end(), v);
      if (found == corners.end()) continue;
      std::iter_swap(corners.begin(), found);
      points.vertices.row(i++) = corners;
      break;
    }
  }
  return points;
}

ContactPoints inner_contacts(const SimMesh& mesh, int count, std::uint64_t seed) {
  CounterRng rng(seed);
  ContactPoints points{RowMatrixXi(count * mesh.E.rows(), mesh.E.cols()),
                       RowMatrixXd(count * mesh.E.rows(), mesh.E.cols()), mesh.dimension()};
  for (Eigen::Index i = 0; i < points.vertices.rows(); ++i) {
    const Eigen::Index e = i / count;
    points.vertices.row(i) = mesh.E.row(e);
    for (Eigen::Index k = 0; k < mesh.E.cols(); ++k) {  // nearer to the lower corners
      points.weights(i, k) = rng.uniform(0.2, 1) * (mesh.V(mesh.E(e, k), 1) < 0.05 ? 20 : 1);
    }
    points.weights.row(i) /= points.weights.row(i).sum();
  }
  return points;
}

ContactPoints join(const ContactPoints& a, const ContactPoints& b) {
  ContactPoints both;
  both.dimension = a.dimension;
  both.vertices.resize(a.size() + b.size(), a.corners());
  both.weights.resize(a.size() + b.size(), a.corners());
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
          multilinear_weights(mesh.V),
          {},
          vertex_contacts(sim_mesh(mesh)),
          settings(model_schema(), scene.model),
          settings(regularizer_schema(), scene.regularizer),
          settings(contact_schema(), scene.contact),
          settings(controller_schema(), scene.controller),
          settings(solver_schema(), scene.solver)};
}

std::vector<BodyCase> body_cases(std::span<const ModelEntry> models, std::span<const RestSpaceEntry> spaces) {
  std::vector<BodyCase> cases;
  for (const ModelEntry& model : models) {
    for (const NamedMesh& mesh : small_meshes(model.dimension, model.element_points)) {
      for (const RestSpaceEntry& space : spaces) cases.push_back({model, space, mesh});
    }
  }
  return cases;
}

std::string case_name(const ::testing::TestParamInfo<BodyCase>& tested) {
  const auto& [model, space, mesh] = tested.param;
  return std::string(model.name) + "_" + mesh.name + "_" + std::string(space.name);
}

BodyInput body_input(const BodyCase& body, const Scene& scene) {
  const SimMesh& mesh = body.mesh.mesh;
  const std::string model =
      "{type: " + std::string(body.model.name) + (scene.model.empty() ? "" : ", " + scene.model) + "}";
  return {body.mesh.name,
          mesh,
          std::string(body.space.name),
          multilinear_weights(mesh.V),
          smooth_poses(mesh),
          vertex_contacts(mesh),
          settings(model_schema({&body.model, 1}), model),
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
    const Eigen::Index d = body.model().dimension();
    moving.put(group + "/x", RowMatrixXd(x.reshaped<Eigen::RowMajor>(x.size() / d, d)));
    moving.put(group + "/v", RowMatrixXd(v.reshaped<Eigen::RowMajor>(v.size() / d, d)));
    moving.put(group + "/restart/q", reader.vector(group + "/restart/q"));
    moving.put(group + "/restart/contact", reader.matrix(group + "/restart/contact"));
    moving.put(group + "/restart/controller", reader.vector(group + "/restart/controller"));
    moving.save(path);
  }
  world.restore(Hdf5Reader(path));
  std::filesystem::remove(path);
}

Vector flat(const RowMatrixXd& V) { return Eigen::Map<const Vector>(V.data(), V.size()); }
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

Matrix random_rotation(int dimension, CounterRng& rng) {
  if (dimension == 3) return random_rotation(rng);
  return Eigen::Rotation2Dd(rng.uniform(0.5, 3)).toRotationMatrix();
}

Vector moved(const Matrix& R, const Vector& b, const Vector& x) {
  const Eigen::Index d = R.rows();
  return ((R * x.reshaped(d, x.size() / d)).colwise() + b).reshaped();
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

namespace {

double difference_error(const Function& f, const Vector& x, const Vector& d, const Vector& exact,
                        double eps) {
  return ((f(x + eps * d) - f(x - eps * d)) / (2 * eps) - exact).norm();
}

}  // namespace

double convergence(const Function& f, const Vector& x, const Vector& d, const Vector& exact, double eps) {
  return difference_error(f, x, d, exact, 2 * eps) / difference_error(f, x, d, exact, eps);
}

::testing::AssertionResult converges(const Function& f, const Vector& x, const Vector& d, const Vector& exact,
                                     double eps) {
  const double rounding = 1e-10 * exact.norm();
  const double coarse = difference_error(f, x, d, exact, 2 * eps),
               fine = difference_error(f, x, d, exact, eps);
  if (coarse <= rounding || (coarse >= 3.8 * fine && coarse <= 4.2 * fine))
    return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "errors " << coarse << " and " << fine << " of " << exact.norm();
}

RandomStep::RandomStep(std::uint64_t seed, double friction, double noise)
    : RandomStep({elastic_models()[0], rest_space_entry("cage"), {"box", sim_mesh(small_box())}},
                 {.model = "density: 300, stiffness: 88000, volume_stiffness: 88000",
                  .regularizer = "{stiffness: 0.03, volume_stiffness: 0.03, rate: 0.03}"},
                 seed, friction, noise) {}

RandomStep::RandomStep(const BodyCase& tested, const Scene& scene, std::uint64_t seed, double friction,
                       double noise) {
  CounterRng rng(seed);
  const WorldSettings world;
  const int d = tested.model.dimension;
  const Matrix tilt = random_rotation(d, rng);
  const Vector origin = Vector::Zero(d), straight = flat(tested.mesh.mesh.V);
  BodyCase tilted = tested;
  tilted.mesh.mesh.V = moved(tilt, origin, straight).reshaped<Eigen::RowMajor>(straight.size() / d, d);
  BodyInput input = body_input(tilted, scene);
  input.contact_points = join(vertex_contacts(tested.mesh.mesh), inner_contacts(tested.mesh.mesh, 2, seed));
  body = make_body_model(input, world, tested.model, tested.space);
  const double layer = 0.02;
  const double point_weight = body.weight / 10;
  const ContactParameters parameters = {layer, point_weight / (layer * layer), 2 * point_weight / layer};

  // Sheared and noisy, the lowest layer of vertices near the plane y = 0, then all tilted.
  Vector lying = straight + random_vector(straight.size(), noise, rng);
  int low = 0;
  for (Eigen::Index i = 0; i < lying.size(); i += d) {
    if (straight[i + 1] < 0.05) {
      lying[i + 1] = layer * (low++ % 4 < 3 ? rng.uniform(0.1, 0.85) : rng.uniform(1.15, 2));
    } else {
      lying[i] += 0.1 * straight[i + 1];
      lying[i + 1] -= 0.05 * straight[i + 1];
    }
  }
  x = moved(tilt, origin, lying);
  // Away from the kinks of the hull, on either side.
  q = random_vector(body.rest->free_parameters(), 0.04 * body.rest->unit(), rng);
  for (const std::vector<int>& group : body.rest->groups()) {
    for (const int k : group) q[k] += k % 3 == 0 ? 0.7 : k % 3 == 1 ? 0.5 : -0.15;
  }
  const Vector q_n = q + random_vector(q.size(), 0.02 * body.rest->unit(), rng);
  const Vector x_tilde = x + random_vector(x.size(), 0.005, rng);

  // What the points remember: every third one has just arrived, the others are 0.3 or 1.7 slip limits from
  // their anchors (with unlimited friction: as far, of the limit for μ = 1).
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (int n = 0; n < d; ++n) normal[n] = tilt(n, 1);
  colliders = one(plane(friction, normal));
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
    Vector direction(d);
    if (d == 2) {
      direction << (angle < 3.14 ? 1 : -1), rng.uniform(-0.5, 0.5);
    } else {
      direction << std::cos(angle), rng.uniform(-0.5, 0.5), std::sin(angle);
    }
    point.anchor = body.contact_points.position(i, x);
    point.anchor.head(d) -= (i % 3 == 0 ? 0.3 : 1.7) * limit * (tilt * direction);
  }
  contacts = ContactSet(body.contact_points, parameters, colliders, x, 0.1, memory);
  for (const Contact& contact : contacts.contacts()) {
    const double distance = contacts.distance(contact, x);
    (distance < layer ? pressing : above) += 1;
    room = std::min(room, std::abs(distance - layer));
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
    wanted.push_back({centre_of_mass_weights(body.mass, Eigen::Vector3d::Unit(axis), d), 2 * kd, kd,
                      rng.uniform(-0.2, 0.2), rng.uniform(-1, 1)});
    wanted.push_back(
        {spin_weights(body.mass, x_tilde, Eigen::Vector3d::Unit(axis)), 0, 0.3 * kd, 0, rng.uniform(-1, 1)});
  }
  goals = make_goals(wanted, x_tilde, world.h);
  // The last step ended a little elsewhere, which damping sees.
  const Vector x_n = x + random_vector(x.size(), 0.005, rng);
  problem = std::make_unique<StepProblem>(body, contacts, goals, x_n, x_tilde, q_n, world.h);
  in_air = std::make_unique<StepProblem>(body, no_contacts, goals, x_n, x_tilde, q_n, world.h);
  workspace = std::make_unique<StepWorkspace>(*body.pattern);
}

}  // namespace vivify::sim
