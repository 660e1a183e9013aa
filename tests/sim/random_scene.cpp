#include "tests/sim/random_scene.h"

#include <Eigen/Geometry>
#include <chrono>
#include <cmath>
#include <numbers>
#include <sstream>

#include "sim/control/rigid_motion.h"
#include "sim/settings.h"

namespace vivify::sim {
namespace {

constexpr double kGravity = 9.81;
constexpr double kLongestDrop = 5;  // m

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : rng_(hash_words(seed, 0x5ce9e)) {}
  double uniform(double low, double high) { return rng_.uniform(low, high); }
  double log_uniform(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }
  int integer(int low, int high) { return low + static_cast<int>(rng_.next() % (high - low + 1)); }
  bool chance(double share) { return rng_.uniform() < share; }
  template <class T>
  T pick(std::initializer_list<T> from) {
    return from.begin()[integer(0, static_cast<int>(from.size()) - 1)];
  }
  CounterRng& rng() { return rng_; }

 private:
  CounterRng rng_;
};

std::string number(double value) {
  std::ostringstream out;
  out.precision(17);
  out << value;
  return out.str();
}
std::string brief(double value) {
  std::ostringstream out;
  out.precision(2);
  out << value;
  return out.str();
}

NamedMesh random_rod(Dice& dice) {
  const bool closed = dice.chance(0.5);
  const int n = dice.integer(closed ? 3 : 2, 16), shape = dice.integer(0, 2);
  const double flat = dice.log_uniform(0.1, 1);
  NamedMesh rod{closed ? "ring" : "rod", {RowMatrixXd(n, 2), RowMatrixXi(closed ? n : n - 1, 2)}};
  for (int i = 0; i < n; ++i) {
    const double share = (i + dice.uniform(-0.35, 0.35)) / (closed ? n : std::max(1, n - 1));
    const double angle = 2 * std::numbers::pi * share;
    if (closed) {
      rod.mesh.V.row(i) << std::cos(angle), flat * std::sin(angle);
    } else if (shape == 0) {
      rod.mesh.V.row(i) << share, 0;
    } else if (shape == 1) {
      rod.mesh.V.row(i) << std::cos(0.4 * angle), std::sin(0.4 * angle);
    } else {
      rod.mesh.V.row(i) << flat * std::sin(2 * angle), share;
    }
    if (i < rod.mesh.E.rows()) rod.mesh.E.row(i) << i, (i + 1) % n;
  }
  return rod;
}

// Cells of two triangles, on the unit square.
NamedMesh random_sheet(Dice& dice) {
  const int nx = dice.integer(1, 5), ny = dice.integer(1, 5);
  NamedMesh sheet{"sheet", {RowMatrixXd((nx + 1) * (ny + 1), 2), RowMatrixXi(2 * nx * ny, 3)}};
  int t = 0;
  for (int j = 0; j <= ny; ++j) {
    for (int i = 0; i <= nx; ++i) {
      const int a = i + (nx + 1) * j, b = a + 1, c = a + nx + 2, d = a + nx + 1;
      sheet.mesh.V.row(a) << static_cast<double>(i) / nx, static_cast<double>(j) / ny;
      if (i == nx || j == ny) continue;
      const bool rising = dice.chance(0.5);
      sheet.mesh.E.row(t++) << a, b, (rising ? c : d);
      sheet.mesh.E.row(t++) << (rising ? a : b), c, d;
    }
  }
  return sheet;
}

NamedMesh random_shell(Dice& dice) {
  if (dice.chance(0.4)) {  // the surface of a box, or of an ellipsoid
    const TetMesh box =
        box_mesh({dice.integer(1, 3), dice.integer(1, 3), dice.integer(1, 3)}, {1, 1, 1}, {-0.5, -0.5, -0.5});
    const Triangles faces = boundary_faces(box);
    std::vector<int> place(static_cast<std::size_t>(box.V.rows()), -1);
    int count = 0;
    for (const int v : faces.reshaped()) {
      if (place[static_cast<std::size_t>(v)] < 0) place[static_cast<std::size_t>(v)] = count++;
    }
    const bool round = dice.chance(0.5);
    NamedMesh shell{round ? "ball" : "hull", {RowMatrixXd(count, 3), RowMatrixXi(faces.rows(), 3)}};
    for (Eigen::Index v = 0; v < box.V.rows(); ++v) {
      const int at = place[static_cast<std::size_t>(v)];
      if (at >= 0) shell.mesh.V.row(at) = round ? box.V.row(v).normalized().eval() : box.V.row(v).eval();
    }
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
      for (int k = 0; k < 3; ++k) shell.mesh.E(f, k) = place[static_cast<std::size_t>(faces(f, k))];
    }
    return shell;
  }
  const NamedMesh sheet = random_sheet(dice);
  const double turn = dice.pick({0.0, 1.0, 2.5});  // flat, bent, nearly a tube
  NamedMesh shell{turn == 0 ? "flat shell" : "bent shell",
                  {RowMatrixXd(sheet.mesh.V.rows(), 3), sheet.mesh.E}};
  for (Eigen::Index i = 0; i < sheet.mesh.V.rows(); ++i) {
    const double u = sheet.mesh.V(i, 0) - 0.5, w = sheet.mesh.V(i, 1);
    if (turn == 0) {
      shell.mesh.V.row(i) << u, w, 0;
    } else {
      shell.mesh.V.row(i) << std::sin(turn * u) / turn, std::cos(turn * u) / turn, w;
    }
  }
  return shell;
}

NamedMesh random_solid(Dice& dice) {
  return {"solid", sim_mesh(box_mesh({dice.integer(1, 3), dice.integer(1, 3), dice.integer(1, 2)}, {1, 1, 1},
                                     {0, 0, 0}))};
}

// Moves vertices about, but leaves every element at least `least` of its size.
void shake(SimMesh& mesh, double scale, double least, Dice& dice) {
  const Eigen::VectorXd sizes = element_sizes(mesh);
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
    const Eigen::RowVectorXd before = mesh.V.row(i);
    mesh.V.row(i) += random_vector(mesh.V.cols(), scale, dice.rng()).transpose();
    if (!(element_sizes(mesh).cwiseQuotient(sizes).minCoeff() >= least)) mesh.V.row(i) = before;
  }
}

// Linear part near the identity plus a bend, turned as a whole.
ExamplePose random_pose(const SimMesh& mesh, int index, Dice& dice) {
  const RowMatrixXd& V = mesh.V;
  const Eigen::Index d = V.cols();
  const Eigen::RowVectorXd centre = V.colwise().mean();
  const double size = (V.rowwise() - centre).cwiseAbs().maxCoeff();
  Matrix A = Matrix::Identity(d, d) + random_vector(d * d, 0.25, dice.rng()).reshaped(d, d);
  double bend = dice.uniform(-0.3, 0.3) / size;
  const Matrix R = random_rotation(static_cast<int>(d), dice.rng());
  ExamplePose pose{"pose " + std::to_string(index), dice.chance(0.5) ? "a" : "b", V};
  do {  // slivers turn inside out easily
    for (Eigen::Index i = 0; i < V.rows(); ++i) {
      Vector u = (V.row(i) - centre).transpose();
      u[0] += bend * u[1] * u[1];
      pose.V.row(i) = (R * A * u).transpose();
    }
    bend *= 0.3;
  } while (element_sizes({pose.V, mesh.E}).minCoeff() <= 0);
  return pose;
}

Collider block(const Eigen::Vector3d& middle, const Eigen::Vector3d& size, double friction) {
  const TetMesh box = box_mesh({1, 1, 1}, size, middle - size / 2);
  TriangleMesh surface;
  surface.V = box.V;
  surface.F = boundary_faces(box);
  return Collider("block", surface, friction);
}

}  // namespace

RandomScene random_scene(std::uint64_t seed) {
  Dice dice(seed);
  RandomScene scene;
  std::ostringstream text;
  const ModelEntry& model = elastic_models()[seed % elastic_models().size()];
  const std::string space = dice.pick<std::string>({"cage", "full", "examples", "examples", "strains"});
  const int d = model.dimension;

  NamedMesh named = model.element_points == 2   ? random_rod(dice)
                    : model.element_points == 4 ? random_solid(dice)
                    : d == 2                    ? random_sheet(dice)
                                                : random_shell(dice);
  SimMesh& mesh = named.mesh;
  if (model.element_points > 2 && dice.chance(0.7)) shake(mesh, dice.log_uniform(0.01, 0.4), 0.02, dice);
  for (Eigen::Index axis = 0; axis < d; ++axis)
    mesh.V.col(axis) *= dice.log_uniform(0.2, 1);  // slabs, columns
  mesh.V *= dice.log_uniform(0.2, 3) / unit_length(mesh.V);
  if (dice.chance(0.5)) mesh.V = (mesh.V * random_rotation(d, dice.rng()).transpose()).eval();
  const double height = unit_length(mesh.V);
  text << model.name << ", " << space << ", " << named.name << " of " << mesh.V.rows() << " vertices, "
       << brief(height) << " m";

  // Stiffness from a hundredth to a hundred times what carries the body well.
  const double density = dice.log_uniform(30, 1000), decades = dice.log_uniform(0.01, 100);
  const double lively = 45 * density * kGravity * height * decades, ratio = dice.log_uniform(1e-3, 100);
  std::string material = "{type: " + std::string(model.name) + ", density: " + number(density);
  if (model.element_points == 2) material = "{type: rod2d, density: " + number(density * 0.1 * height);
  if (model.name == "shell3d") material = "{type: shell3d, density: " + number(density * 0.1 * height);
  const bool thin = model.element_points == 2 || model.name == "shell3d";
  text << ", stiffness x " << brief(decades);
  if (dice.chance(0.3)) {
    material += ", young: " + number(lively);
    if (thin) material += ", thickness: " + number(height * dice.log_uniform(0.01, 0.2));
    if (!thin) material += ", poisson: " + number(dice.uniform(model.name == "solid3d" ? 0.25 : 0.0, 0.49));
    text << " (Young)";
  } else {
    const double k = thin ? 0.1 * height * lively : lively;
    material += ", stiffness: " + number(k);
    material +=
        thin ? ", bending_stiffness: " + number(dice.chance(0.1) ? 0 : ratio * k * height * height * 0.01)
             : ", volume_stiffness: " + number(dice.chance(0.1) ? 0 : ratio * k);
    text << ", ratio " << brief(ratio);
  }
  if (dice.chance(0.5)) {
    const double damping = dice.log_uniform(1e-4, 0.1);
    material += ", damping_s: " + number(damping);
    text << ", damped " << brief(damping);
  }
  material += "}";

  const double h = 1 / dice.uniform(24, 200);
  const double regularizer = dice.log_uniform(1e-6, 0.1);
  std::ostringstream costs, layer, solver, controller;
  costs << "{stiffness: " << number(regularizer)
        << ", volume_stiffness: " << (dice.chance(0.3) ? 0 : regularizer)
        << ", bending_stiffness: " << (dice.chance(0.3) ? 0 : regularizer)
        << ", hull: " << dice.pick({0.0, 10.0}) << ", rate: " << dice.pick({0.0, 0.03}) << "}";
  layer << "{layer: " << number(dice.log_uniform(5e-4, 0.05)) << "}";
  const std::string method = dice.pick<std::string>({"sqp", "sqp", "reduced"});
  const bool exact = dice.chance(0.3);
  solver << "{method: " << method << ", exact_hessian: " << (exact ? "true" : "false") << "}";
  const double effort = dice.log_uniform(0.1, 100);
  const int kind = dice.integer(0, 9);
  const double heading = d == 2 ? (dice.chance(0.5) ? 90 : -90) : dice.uniform(-180, 180);
  const bool weighs = space == "examples" || space == "strains";
  if (kind == 0) {
    controller << "{type: rest}";
  } else if (kind <= 2 && weighs) {  // rest shapes that are prescribed, also beyond the examples
    controller << "{type: blend, keys: [{t: 0, weights: [0, 0, 0]}";
    for (int key = 1; key <= 4; ++key) {
      controller << ", {t: " << 0.15 * key << ", weights: [" << dice.uniform(-0.5, 1.5) << ", "
                 << dice.uniform(-0.5, 1.5) << ", " << dice.uniform(-0.5, 1) << "]}";
    }
    controller << "]}";
  } else if (kind <= 3) {
    controller << "{type: roll, heading_deg: " << heading << ", speed: " << dice.uniform(0, 5)
               << ", ramp_s: " << dice.uniform(0.01, 0.3) << ", effort: " << effort << "}";
  } else {
    controller << "{type: hop, heading_deg: " << heading << ", height: " << dice.log_uniform(0.1, 3)
               << ", pace: " << dice.uniform(0, 5) << ", crouch_depth: " << dice.uniform(0, 0.5)
               << ", crouch_s: " << dice.uniform(0.02, 0.2) << ", thrust_s: " << dice.uniform(0.02, 0.2)
               << ", land_s: " << dice.uniform(0.02, 0.2) << ", effort: " << effort
               << ", upright: " << dice.pick({0.0, 10.0, 100.0})
               << ", face_heading: " << (dice.chance(0.5) ? "true" : "false") << "}";
  }
  text << ", " << method << (exact ? " (exact)" : "") << ", h = 1/" << brief(1 / h) << ", effort "
       << brief(effort) << ", r " << brief(regularizer) << ", "
       << controller.str().substr(1, controller.str().find(',') - 1);

  // Colliders: none, or a plane through the origin, with a wall or a block that the body may hit as well.
  const double tilt = dice.chance(0.5) ? 0 : dice.uniform(-0.6, 0.6);
  const auto friction = [&] { return dice.pick({0.0, 0.5, 1.0, static_cast<double>(INFINITY)}); };
  Eigen::Vector3d normal(-std::sin(tilt), std::cos(tilt), 0);
  if (d == 3) normal = Eigen::AngleAxisd(dice.uniform(0, 6), Eigen::Vector3d::UnitY()) * normal;
  if (!dice.chance(0.1)) {
    scene.colliders.push_back(plane(friction(), normal));
    if (dice.chance(0.3)) {
      scene.colliders.push_back(
          plane(friction(), Eigen::Vector3d(1, 0.3, 0).normalized(), {-1.2 * height, 0, 0}));
    }
    if (dice.chance(0.3)) {
      scene.colliders.push_back(
          block({0.3 * height, 0, 0}, {0.4 * height, 0.6 * height, height}, friction()));
    }
  }
  // The body stands or lies somewhere above the plane.
  const double drop = dice.chance(0.3) ? 0 : dice.uniform(0, 0.3 * height);
  double lowest = INFINITY;
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
    const Eigen::Vector3d point = spatial_point(flat(mesh.V), i, d);
    lowest = std::min(lowest, normal.dot(point));
  }
  for (int axis = 0; axis < d; ++axis) mesh.V.col(axis).array() += (drop - lowest) * normal[axis];
  // What starts inside a collider is refused.
  std::erase_if(scene.colliders, [&](const Collider& collider) {
    double distance = INFINITY;
    const auto look = [&](const Eigen::Vector3d& point) {
      distance = std::min(distance, collider.nearest(point).distance);
    };
    const Vector x = flat(mesh.V);
    for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) look(spatial_point(x, i, d));
    for (Eigen::Index e = 0; e < mesh.E.rows(); ++e) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (Eigen::Index k = 0; k < mesh.E.cols(); ++k) sum += spatial_point(x, mesh.E(e, k), d);
      look(sum / static_cast<double>(mesh.E.cols()));
    }
    const ContactPoints within = inner_contacts(mesh, 1, seed);
    for (int i = 0; i < within.size(); ++i) look(within.position(i, x));
    return distance < -1e-9 * height;
  });
  text << ", " << scene.colliders.size() << " colliders";

  // It starts twisted, squeezed, inverted, shaken, and with the speed of a fall.
  const Vector rest = flat(mesh.V);
  scene.x = rest;
  scene.v = Vector::Zero(rest.size());
  const Vector centre = mesh.V.colwise().mean().transpose();
  const int start = dice.integer(0, 4);
  const char* const kStarts[] = {"still", "squeezed", "twisted", "shaken", "turned inside out"};
  text << ", " << kStarts[start];
  Vector squeeze = Vector::Ones(d);
  double twist = 0, noise = 0;
  if (start == 1) squeeze = squeeze.unaryExpr([&](double) { return dice.log_uniform(0.1, 2); });
  if (start == 2) twist = dice.uniform(-3, 3) / height;
  if (start == 3) noise = height * dice.log_uniform(0.01, 0.5);
  if (start == 4) squeeze[dice.integer(0, d - 1)] = -dice.uniform(0.05, 1);
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
    Vector arm = (rest.segment(d * i, d) - centre).cwiseProduct(squeeze);
    const double angle = twist * arm[1], c = std::cos(angle), s = std::sin(angle);
    if (d == 3) {
      arm = Eigen::Vector3d(c * arm[0] + s * arm[2], arm[1], c * arm[2] - s * arm[0]);
    } else {
      arm = Eigen::Vector2d(c * arm[0] + s * arm[1], c * arm[1] - s * arm[0]);
    }
    scene.x.segment(d * i, d) = centre + arm + random_vector(d, noise, dice.rng());
  }
  if (dice.chance(0.6)) {
    const double fallen = dice.uniform(0, kLongestDrop), spin = dice.chance(0.5) ? dice.uniform(-10, 10) : 0;
    for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
      const Vector arm = scene.x.segment(d * i, d) - centre;
      scene.v[d * i] += -spin * arm[1];
      scene.v[d * i + 1] += spin * arm[0] - std::sqrt(2 * kGravity * fallen);
    }
    text << ", falls from " << brief(fallen) << " m";
    if (spin != 0) text << " with spin " << brief(spin) << "/s";
  }

  RowMatrixXd padded(mesh.V.rows() + 2, d);
  const Eigen::RowVectorXd margin = Eigen::RowVectorXd::Constant(d, 0.1 * height);
  padded << mesh.V, mesh.V.colwise().minCoeff() - margin, mesh.V.colwise().maxCoeff() + margin;
  std::vector<ExamplePose> poses;
  for (int k = 0; k < 3; ++k) poses.push_back(random_pose(mesh, k, dice));
  ContactPoints points = vertex_contacts(mesh);
  if (dice.chance(0.5)) points = join(points, inner_contacts(mesh, 1, seed));
  const std::string name = "body " + std::to_string(seed);
  scene.body = {name,
                mesh,
                space,
                multilinear_weights(padded).topRows(mesh.V.rows()),
                poses,
                points,
                settings(model_schema(), material),
                settings(regularizer_schema(), costs.str()),
                settings(contact_schema(), layer.str()),
                settings(controller_schema(), controller.str()),
                settings(solver_schema(), solver.str())};
  scene.settings.h = h;
  scene.steps = dice.integer(30, 120);
  scene.text = text.str();
  return scene;
}

RandomRun simulate(RandomScene scene) {
  RandomRun run;
  World world({scene.body}, std::move(scene.colliders), scene.settings);
  set_motion(world, scene.x, scene.v);
  run.weight = world.body(0).model().weight;
  run.height = world.body(0).model().height;
  for (int step = 0; step < scene.steps && run.error.empty(); ++step) {
    const auto begin = std::chrono::steady_clock::now();
    try {
      world.step();
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::numerical) throw;
      run.error = error.what();
      run.hint = error.hint();
    }
    run.seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  run.records = world.records();
  run.x = world.body(0).x();
  run.v = world.body(0).v();
  return run;
}

}  // namespace vivify::sim
