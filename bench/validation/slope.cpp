#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/validation/problem.h"
#include "bench/validation/standing.h"

namespace vivify::validation {
namespace {

constexpr double kAngle = 26.565;                          // °: tan = 0.499999
constexpr double kSoftFriction = 0.502;                    // μ with soft blocks
constexpr double kRest = 0.5, kTilting = 4, kWatched = 5;  // s

double tilt(double t) {  // radians, as RigidPath goes from key to key
  const double s = std::clamp((t - kRest) / kTilting, 0.0, 1.0);
  return kAngle * std::numbers::pi / 180 * s * s * (3 - 2 * s);
}

// Path along the slope of a rigid block under Coulomb's law, from rest, at the times n h.
std::vector<double> coulomb_path(double friction, double h, int steps) {
  constexpr int kParts = 100;
  std::vector<double> path = {0};
  double s = 0, v = 0;
  for (int n = 0; n < steps; ++n) {
    for (int part = 0; part < kParts; ++part) {
      const double angle = tilt((n + (part + 0.5) / kParts) * h);
      const double a = kGravity * (std::sin(angle) - friction * std::cos(angle));
      const double next = std::max(0.0, v + a * h / kParts);
      s += 0.5 * (v + next) * h / kParts;
      v = next;
    }
    path.push_back(s);
  }
  return path;
}

// Thin bodies are light for their stiffness: more of it would drown their weight in rounding.
std::vector<Sample> stiff_blocks() {
  std::vector<Sample> list = blocks();
  for (Sample& sample : list) {
    const bool thin = sample.model == "rod2d" || sample.model == "shell3d";
    sample.yaml = "{type: " + sample.model + ", damping_s: 0.01, stiffness: " + (thin ? "1e6" : "1e8") + "}";
  }
  return list;
}

struct Run {
  Curve path;             // along the slope since the beginning
  double give = 0;        // path until the slope stands, m
  double afterwards = 0;  // farthest from there later, m
};

Run tilted(const Sample& sample, double friction, double h) {
  sim::BodyInput input = standing_body(sample.mesh, sample.yaml);
  // About the centre of mass: turning alone asks for no friction.
  const Vector mass = sim::make_body_model(input, {}).mass;
  const double height = mass.dot(sample.mesh.V.col(1)) / mass.sum();
  input.rest = moved(sample.mesh, {0, -height, 0});
  const sim::RigidPath turn(
      {{kRest, {0, 0, 0}, {0, 0, 0}, {}}, {kRest + kTilting, {0, 0, 0}, {0, 0, -kAngle}, {}}}, false);
  sim::ShapePlace below;
  below.pose.translation().y() = -height;
  std::vector<sim::Collider> slope;
  slope.emplace_back("slope",
                     sim::make_collider_shape(settings(sim::collider_shape_schema(), "{type: plane}"), below),
                     friction, turn);
  sim::World world({input}, std::move(slope), {{0, -kGravity, 0}, h});
  Run run;
  const double from = centre(world).x();
  const int steps = static_cast<int>(std::lround((kRest + kTilting + kWatched) / h));
  for (int n = 1; n <= steps; ++n) {
    world.step();
    const double path = (turn.pose(world.time()).inverse() * centre(world)).x() - from;
    if (world.time() < kRest + kTilting + 0.5 * h) run.give = path;
    run.afterwards = std::max(run.afterwards, std::abs(path - run.give));
    if (n % 10 == 0) run.path.add(world.time(), path);
  }
  return run;
}

}  // namespace

Result slope(Effort) {
  constexpr double h = 0.01;
  Result result;
  result.title = "Critical angle of a slope";
  result.text =
      "Blocks of every model on a plane that stands level for 0.5 s, tilts to 26.565° (tan θ = "
      "0.499999) about their centre of mass within 4 s, and stays there for 5 s. Stiff ones "
      "(`stiffness` 1e8, of rods and shells 1e6) must hold with μ = 0.50: their centre of mass moves "
      "by no more than 1 mm in 5 s, nor while the plane tilts, when the anchored springs of friction "
      "give. With μ = 0.49 they must slide as a rigid block does under Coulomb's law. Soft ones "
      "(standard `stiffness`) must hold with μ = 0.502. On the critical slope itself a body rests only "
      "while every point uses its whole friction, straight up the slope, but for 2 parts in a million. "
      "Soft solids in space have spread sideways under their weight and use a part of their friction "
      "against that (`solid3d` 16 % at 4.1 s): their points slip until it has gone, and what they have "
      "gained by then stays, since at this angle Coulomb's law slows a sliding body down by 1e-5 m/s² "
      "only. 0.4 % more friction than critical stops them at once. h = 1/100 s.";
  Plot slides{"slope_slides", "Stiff blocks on a slope of 26.565°, μ = 0.49", "t (s)",
              "path down the slope (m)"};
  Plot holds{"slope_holds", "Stiff blocks on a slope of 26.565°, μ = 0.50", "t (s)",
             "path down the slope (mm)"};
  Table soft{"Soft blocks: path in the 5 s on the slope (mm).", {"model", "μ = 0.500", "μ = 0.502"}};
  const int steps = static_cast<int>(std::lround((kRest + kTilting + kWatched) / h));
  const std::vector<double> reference = coulomb_path(0.49, h, steps);
  const auto standing = static_cast<std::size_t>(std::lround((kRest + kTilting) / h));
  for (const Sample& sample : stiff_blocks()) {
    Run at_rest = tilted(sample, 0.5, h), sliding = tilted(sample, 0.49, h);
    result.figure(sample.model + ", stiff, μ = 0.50: largest path in 5 s, m", at_rest.afterwards, 0, 1e-3);
    result.figure(sample.model + ", stiff, μ = 0.50: path while the slope tilts, m", at_rest.give, 0, 1e-3);
    result.figure(sample.model + ", stiff, μ = 0.49: path in 5 s, m", sliding.afterwards,
                  reference.back() - reference[standing], 0.02);
    at_rest.path.name = sliding.path.name = sample.model;
    for (double& y : at_rest.path.y) y *= 1e3;
    holds.curves.push_back(std::move(at_rest.path));
    slides.curves.push_back(std::move(sliding.path));
  }
  for (const Sample& sample : blocks(", damping_s: 0.01")) {
    const double critical = tilted(sample, 0.5, h).afterwards,
                 holding = tilted(sample, kSoftFriction, h).afterwards;
    result.figure(sample.model + ", soft, μ = 0.502: largest path in 5 s, m", holding, 0, 1e-3);
    soft.rows.push_back({sample.model, short_number(1e3 * critical), short_number(1e3 * holding)});
  }
  Curve coulomb{"rigid block", {}, {}, true};
  for (int n = 0; n <= steps; n += 10) coulomb.add(n * h, reference[static_cast<std::size_t>(n)]);
  slides.curves.push_back(std::move(coulomb));
  result.plots = {std::move(slides), std::move(holds)};
  result.tables.push_back(std::move(soft));
  return result;
}

}  // namespace vivify::validation
