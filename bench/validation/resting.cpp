#include <algorithm>
#include <cmath>

#include "bench/validation/lattice.h"
#include "bench/validation/problem.h"
#include "bench/validation/standing.h"

namespace vivify::validation {
namespace {

constexpr double kDensity = 300, kSmaller = 0.7;  // of the lower body, kg/m³; scale of the upper one

// A box of 0.4 m by 0.2 m, scaled, on four feet: its lower corners.
SimMesh stool(double scale) {
  SimMesh mesh = box(2, 1, 2, 0.4 * scale, 0.2 * scale, 0.4 * scale);
  const double low = mesh.V.col(1).minCoeff(), foot = 0.02 * scale;
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
    const bool corner = std::abs(std::abs(mesh.V(i, 0) - 0.2 * scale) - 0.2 * scale) < 1e-9 &&
                        std::abs(std::abs(mesh.V(i, 2)) - 0.2 * scale) < 1e-9 && mesh.V(i, 1) == low;
    mesh.V(i, 1) += (corner ? 0 : foot) - low;
    mesh.V(i, 0) -= 0.2 * scale;
  }
  return mesh;
}

std::string model(double density) {
  return "{type: solid3d, density: " + std::to_string(density) +
         ", stiffness: 1e6, volume_stiffness: 1e6, damping_s: 0.02}";
}

struct Rest {
  double ground = 0, between = 0;  // mean height of the feet, m
  double speed = 0;                // of a vertex at the end, m/s
};

// A stool on a plane, with a smaller one of another density on top unless that is 0.
Rest settle(double density, double h, double seconds) {
  std::vector<sim::BodyInput> bodies = {standing_body(stool(1), model(kDensity), "lower")};
  if (density > 0) {
    bodies.push_back(standing_body(moved(stool(kSmaller), {0.01, 0.22, 0.013}), model(density), "upper"));
  }
  sim::World world(bodies, inclined_plane(1), {{0, -kGravity, 0}, h});
  while (world.time() < seconds) world.step();
  Rest rest;
  const sim::Body& lower = world.body(0);
  for (std::size_t i = 0; i < lower.state().contacts.size(); ++i) {
    if (!lower.state().contacts[i].touching) continue;
    const Eigen::Vector3d y = lower.model().contact_points.position(static_cast<int>(i), lower.x());
    rest.ground += 0.25 * y.y();
  }
  for (const sim::PairMemory& foot : world.touching()) rest.between += 0.25 * foot.distance;
  for (int b = 0; b < world.body_count(); ++b)
    rest.speed = std::max(rest.speed, world.body(b).v().lpNorm<Eigen::Infinity>());
  return rest;
}

// Height over δ of four feet that bear `load` together, in units of the weight that one alone could bear.
double height_under(double load) { return 1 - std::sqrt(load / 4); }

}  // namespace

Result resting(Effort effort) {
  Result result;
  result.title = "Resting penetration";
  result.text =
      "A block on four feet, with a smaller one of another density on top. Alone, each of the n "
      "standing points of a body of weight W has the normal force (W / n) (1 − d / δ)² at the height d "
      "within the contact layer δ: at rest the feet must stand at d = 0, whatever the step. Where "
      "bodies touch, each place could bear the heaviest of them alone, W (1 − d / δ)²: under n feet "
      "that bear the load F the height must be δ (1 − √(F / n W)). Heights are the mean over four "
      "feet, in units of δ, from the positions.";
  const double seconds = 3;
  const sim::BodyModel lower = make_body_model(standing_body(stool(1), model(kDensity)), {});
  const double layer = lower.contact.layer;
  for (const double h : {1.0 / 50, 1.0 / 100, 1.0 / 200}) {
    const Rest rest = settle(0, h, seconds);
    result.figure("alone, h = " + short_number(h) + " s: height of the feet over δ", rest.ground / layer, 0,
                  1e-6);
  }
  Plot plot{"resting", "Resting height under a load", "load / weight", "height / δ"};
  Curve ground{"feet on the plane"}, between{"feet on the other body"},
      ground_law{"1 − √((1 + load / W) / 4)", {}, {}, true}, between_law{"1 − √(load / 4 W)", {}, {}, true};
  const std::vector<double> densities = effort == Effort::full
                                            ? std::vector<double>{50, 100, 200, 300, 450, 600, 850}
                                            : std::vector<double>{150, 850};
  Largest ground_error, between_error, speed;
  for (const double density : densities) {
    const sim::BodyModel upper = make_body_model(standing_body(stool(kSmaller), model(density)), {});
    const double load = upper.weight / lower.weight;
    const Rest rest = settle(density, 0.01, seconds);
    ground.add(load, rest.ground / layer);
    between.add(load, rest.between / layer);
    ground_error.add(std::abs(ground.y.back() - height_under(1 + load)));
    between_error.add(std::abs(between.y.back() - height_under(load)));
    speed.add(rest.speed);
  }
  for (double load = 0.05; load <= 1.001; load += 0.05) {
    ground_law.add(load, height_under(1 + load));
    between_law.add(load, height_under(load));
  }
  result.figure("loaded: height over the plane, largest difference over δ", ground_error.value, 0, 1e-3);
  result.figure("loaded: height over the other body, largest difference over δ", between_error.value, 0,
                1e-3);
  result.figure("loaded: largest speed of a vertex at the end, m/s", speed.value, 0, 1e-6);
  plot.curves = {std::move(ground), std::move(between), std::move(ground_law), std::move(between_law)};
  result.plots.push_back(std::move(plot));
  return result;
}

}  // namespace vivify::validation
