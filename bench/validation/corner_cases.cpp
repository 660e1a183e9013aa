#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "bench/validation/lattice.h"
#include "bench/validation/problem.h"
#include "bench/validation/standing.h"

namespace vivify::validation {
namespace {

constexpr double kSize = 0.4;  // m, of every body
constexpr double kStep = 1.0 / 100;
const std::string kModel =
    "{type: solid3d, density: 300, stiffness: 4e5, volume_stiffness: 4e5, damping_s: 0.01}";

SimMesh cube() {
  SimMesh mesh = box(2, 2, 2, kSize, kSize, kSize);
  return moved(std::move(mesh), {-kSize / 2, kSize / 2, 0});
}

SimMesh solid(const std::vector<std::array<double, 3>>& points,
              const std::vector<std::array<int, 4>>& tetrahedra) {
  SimMesh mesh{RowMatrixXd(static_cast<Eigen::Index>(points.size()), 3),
               RowMatrixXi(static_cast<Eigen::Index>(tetrahedra.size()), 4)};
  for (std::size_t i = 0; i < points.size(); ++i)
    mesh.V.row(static_cast<Eigen::Index>(i)) << points[i][0], points[i][1], points[i][2];
  mesh.V *= kSize;
  for (std::size_t t = 0; t < tetrahedra.size(); ++t) {
    const auto& [a, b, c, d] = tetrahedra[t];
    const auto edge = [&](int i) -> Eigen::Vector3d { return (mesh.V.row(i) - mesh.V.row(a)).transpose(); };
    const bool turned = edge(b).dot(edge(c).cross(edge(d))) < 0;
    mesh.E.row(static_cast<Eigen::Index>(t)) << a, turned ? c : b, turned ? b : c, d;
  }
  return mesh;
}

// A square pyramid, its point up.
SimMesh spike() {
  return solid({{-0.5, 0, -0.5}, {0.5, 0, -0.5}, {0.5, 0, 0.5}, {-0.5, 0, 0.5}, {0, 0, 0}, {0, 1, 0}},
               {{0, 1, 4, 5}, {1, 2, 4, 5}, {2, 3, 4, 5}, {3, 0, 4, 5}});
}

// A roof with its ridge along z.
SimMesh wedge() {
  return solid({{-0.5, 0, -0.5}, {0.5, 0, -0.5}, {0, 1, -0.5}, {-0.5, 0, 0.5}, {0.5, 0, 0.5}, {0, 1, 0.5}},
               {{0, 1, 2, 3}, {1, 2, 3, 4}, {2, 3, 4, 5}});
}

SimMesh upside_down(SimMesh mesh) {
  mesh.V.leftCols<2>() *= -1;
  mesh.V.col(1).array() += kSize;
  return mesh;
}

SimMesh quarter_turn(SimMesh mesh) {
  const Eigen::VectorXd x = mesh.V.col(0);
  mesh.V.col(0) = mesh.V.col(2);
  mesh.V.col(2) = -x;
  return mesh;
}

// How deep the vertices of one convex body lie in another, m.
double depth_in(const sim::Body& a, const sim::Body& b) {
  const RowMatrixXi& F = b.model().surface.faces;
  const sim::ContactPoints& points = b.model().surface.points;
  double deepest = 0;
  for (Eigen::Index i = 0; i < a.x().size(); i += 3) {
    const Eigen::Vector3d y = a.x().segment<3>(i);
    double depth = INFINITY;
    for (Eigen::Index f = 0; f < F.rows() && depth > 0; ++f) {
      const Eigen::Vector3d p = points.position(F(f, 0), b.x()), q = points.position(F(f, 1), b.x()),
                            r = points.position(F(f, 2), b.x());
      depth = std::min(depth, -(q - p).cross(r - p).normalized().dot(y - p));
    }
    deepest = std::max(deepest, depth);
  }
  return deepest;
}

struct Case {
  std::string name;
  std::vector<SimMesh> lower;
  SimMesh upper;
  bool stands = false;  // the upper body must stay where it is
};

std::vector<Case> cases() {
  const Eigen::Vector3d up(0, kSize + 0.01, 0);
  const auto dropped = [&](SimMesh mesh, const Eigen::Vector3d& by = Eigen::Vector3d::Zero()) {
    return moved(std::move(mesh), up + by);
  };
  return {
      {"spike on spike", {spike()}, dropped(upside_down(spike()), {0.003, 0, 0.002})},
      {"spike on the edge of a wedge", {wedge()}, dropped(upside_down(spike()), {0.002, 0, 0.03})},
      {"wedge across a wedge", {wedge()}, dropped(quarter_turn(upside_down(wedge())), {0.01, 0, 0.02})},
      {"cube on a spike", {spike()}, dropped(cube(), {0.01, 0, 0.02})},
      {"spike on a cube", {cube()}, dropped(upside_down(spike()), {0.01, 0, 0.02})},
      {"spike into a crack",
       {moved(cube(), {-0.25, 0, 0}), moved(cube(), {0.25, 0, 0})},
       dropped(upside_down(spike()), {0, -0.08, 0}),
       true},
      {"wedge into a crack",
       {moved(cube(), {-0.25, 0, 0}), moved(cube(), {0.25, 0, 0})},
       dropped(upside_down(wedge()), {0, -0.08, 0}),
       true},
      {"cube flush with a cliff's edges", {cube()}, dropped(cube(), {0, -0.009, 0}), true},
      {"cube over a cliff's edge", {cube()}, dropped(cube(), {0.08, -0.009, 0.05}), true},
  };
}

struct Outcome {
  double residual = 0;  // of a step, of the weight
  double depth = 0;     // of a vertex in another body, m
  double rise = 0;      // of the energy above that of the start, relative
  double motion = 0;    // of the upper body in the second half, m
  Curve height;
};

Outcome run(const Case& tested, double seconds) {
  std::vector<sim::BodyInput> bodies;
  for (const SimMesh& mesh : tested.lower)
    bodies.push_back(standing_body(mesh, kModel, "lower" + std::to_string(bodies.size())));
  bodies.push_back(standing_body(tested.upper, kModel, "upper"));
  sim::World world(bodies, inclined_plane(1), {{0, -kGravity, 0}, kStep});
  const int upper = world.body_count() - 1;
  Outcome outcome;
  double start = 0;
  for (int b = 0; b <= upper; ++b) start += mass(world, b) * kGravity * centre(world, b).y();
  Eigen::Vector3d from;
  while (world.time() < seconds - 0.5 * kStep) {
    world.step();
    double energy = 0;
    for (int b = 0; b <= upper; ++b) {
      const sim::StepRecord& last = record(world, b);
      energy += last.kinetic + last.elastic + mass(world, b) * kGravity * last.com.y();
      outcome.residual = std::max(outcome.residual, last.residual_rel);
      for (int other = 0; other <= upper; ++other) {
        if (other != b) outcome.depth = std::max(outcome.depth, depth_in(world.body(b), world.body(other)));
      }
    }
    outcome.rise = std::max(outcome.rise, (energy - start) / start);
    if (world.time() < 0.5 * seconds + 0.5 * kStep) from = centre(world, upper);
    outcome.motion = std::max(outcome.motion, (centre(world, upper) - from).norm());
    outcome.height.add(world.time(), centre(world, upper).y());
  }
  return outcome;
}

// A plate that slides at `speed` (m/s) over a row of four cubes side by side, or over one slab of their size.
struct Slide {
  double path = 0;  // until it stops, over v² / 2 μ g
  double hop = 0;   // largest vertical motion of its centre, m
};

Slide slide(bool seams, double speed, double h) {
  constexpr double kFriction = 0.3, kSettled = 0.1;
  std::vector<sim::BodyInput> bodies;
  for (int i = 0; seams && i < 4; ++i)
    bodies.push_back(standing_body(moved(cube(), {i * kSize, 0, 0}), kModel, "tile" + std::to_string(i)));
  if (!seams) {
    SimMesh slab = box(8, 2, 2, 4 * kSize, kSize, kSize);
    bodies.push_back(standing_body(moved(std::move(slab), {-kSize / 2, kSize / 2, 0}), kModel, "slab"));
  }
  SimMesh plate = cube();
  plate.V.col(1) *= 0.5;
  plate.V.col(2) *= 0.7;
  bodies.push_back(standing_body(moved(plate, {-0.05, kSize, 0.017}), kModel, "slider",
                                 "{friction: " + short_number(kFriction) + "}"));
  bodies.back().velocity = {speed, 0, 0};
  sim::World world(bodies, inclined_plane(3), {{0, -kGravity, 0}, h});
  const int slider = world.body_count() - 1;
  Slide slide;
  double from = 0, height = 0, coulomb = 0;
  while (world.time() < 1) {
    world.step();
    if (world.time() < kSettled + 0.5 * h) {
      from = centre(world, slider).x();
      coulomb = std::pow(velocity(world, slider).x(), 2) / (2 * kFriction * kGravity);
      height = centre(world, slider).y();
    }
    slide.path = std::max(slide.path, (centre(world, slider).x() - from) / coulomb);
    slide.hop = std::max(slide.hop, std::abs(centre(world, slider).y() - height));
  }
  return slide;
}

}  // namespace

Result corner_cases(Effort effort) {
  Result result;
  result.title = "Corner cases of contact";
  result.text =
      "The cases of Erleben (2018) that break contact by points and normals alone, between soft bodies "
      "of 0.4 m on a ground with μ = 1: points on points, on edges and into cracks, edges across "
      "edges, faces whose edges are flush, faces over a cliff, and sliding over the seams between "
      "bodies (paths are given over v² / 2 μ g). Every step must be exact, the energy (kinetic, "
      "elastic and of the weight) must not exceed that of the start (but for what the contact layers "
      "hold there), no vertex may lie in another body deeper than the soft contact lets it, and what "
      "can stand must stand.";
  const double seconds = effort == Effort::full ? 2 : 1;
  Plot plot{"corner_cases", "Height of the upper body", "t (s)", "height of its centre (m)"};
  Largest residual;
  for (const Case& tested : cases()) {
    Outcome outcome = run(tested, seconds);
    residual.add(outcome.residual);
    result.figure(tested.name + ": deepest vertex in another body, of its size", outcome.depth / kSize, 0,
                  0.01);
    result.figure(tested.name + ": energy above that of the start, relative", std::max(0.0, outcome.rise), 0,
                  1e-3);
    if (tested.stands) result.figure(tested.name + ": motion in the second half, m", outcome.motion, 0, 1e-3);
    outcome.height.name = tested.name;
    plot.curves.push_back(std::move(outcome.height));
  }
  result.figure("largest residual of any step, of the weight", residual.value, 0, 1e-8);
  Table seams{"Sliding over seams by the step h. Paths over v² / 2 μ g.",
              {"v (m/s)", "h (s)", "path over seams", "path without", "vertical motion (mm)"}};
  const bool full = effort == Effort::full;
  for (const double speed : full ? std::vector<double>{0.5, 1, 2} : std::vector<double>{1, 2}) {
    for (const double h :
         full ? std::vector<double>{1.0 / 60, kStep, 1.0 / 120} : std::vector<double>{kStep}) {
      const Slide over = slide(true, speed, h), without = slide(false, speed, h);
      seams.rows.push_back({short_number(speed), short_number(h), short_number(over.path),
                            short_number(without.path), short_number(1e3 * over.hop)});
      const std::string name =
          "sliding over seams at " + short_number(speed) + " m/s, h = " + short_number(h) + " s: ";
      result.figure(name + "path until it stops, beside that without seams", over.path, without.path, 0.05);
      result.figure(name + "vertical motion of the centre, m", over.hop, 0, 1e-3);
    }
  }
  result.tables.push_back(std::move(seams));
  result.plots.push_back(std::move(plot));
  return result;
}

}  // namespace vivify::validation
