#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/validation/problem.h"
#include "bench/validation/standing.h"

namespace vivify::validation {
namespace {

constexpr double kFriction = 0.5, kAngle = 10;  // °
constexpr double kStart = 0.1;                  // s: until the first touch has died away

struct Stop {
  double speed = 0, distance = 0;  // at kStart, and from there
  double creep = 0;                // farthest from the place of rest in the second after it, m
};

Stop slide(const Sample& sample, double speed, double h) {
  const double angle = kAngle * std::numbers::pi / 180;
  const Eigen::Vector3d down(std::cos(angle), -std::sin(angle), 0);
  sim::BodyInput input = standing_body(inclined(sample.mesh, kAngle), sample.yaml);
  input.velocity = speed * down;
  sim::World world({input}, inclined_plane(kFriction, kAngle), {{0, -kGravity, 0}, h});
  Stop stop;
  double from = 0, rested = 0;
  bool stopped = false;
  for (double end = 10; world.time() < end;) {
    world.step();
    const double path = down.dot(centre(world)), v = down.dot(velocity(world));
    if (world.time() < kStart + 0.5 * h) {
      from = path;
      stop.speed = v;
    } else if (!stopped && v <= 0) {
      stopped = true;
      end = world.time() + 1;
      rested = path;
      stop.distance = path - from;
    }
    if (stopped) stop.creep = std::max(stop.creep, std::abs(path - rested));
  }
  return stop;
}

}  // namespace

Result stopping(Effort effort) {
  Result result;
  result.title = "Stopping distance";
  result.text =
      "Bodies sent down a slope of 10° with μ = 0.5. From 0.1 s on, when the first touch has died away, they "
      "must stop after v₀² / (2 g (μ cos θ − sin θ)) with the speed v₀ that they have then, and stay where "
      "they stopped (within the give of the anchored friction spring and the body). h = 1/200 s.";
  const double h = 1.0 / 200, angle = kAngle * std::numbers::pi / 180;
  const double brake = kGravity * (kFriction * std::cos(angle) - std::sin(angle));
  const std::vector<double> speeds =
      effort == Effort::full ? std::vector<double>{1.5, 2, 3, 4} : std::vector<double>{2};
  Plot plot{"stopping", "Stopping distance on a slope of 10°, μ = 0.5", "v₀ (m/s)", "distance (m)"};
  for (const Sample& sample : blocks(", damping_s: 0.01")) {
    Curve ours{sample.model};
    Largest error, creep;
    for (const double speed : speeds) {
      const Stop stop = slide(sample, speed, h);
      const double expected = stop.speed * stop.speed / (2 * brake);
      ours.add(stop.speed, stop.distance);
      error.add(std::abs(stop.distance - expected) / expected);
      creep.add(stop.creep);
    }
    result.figure(sample.model + ": stopping distance, largest relative error", error.value, 0, 0.02);
    result.figure(sample.model + ": motion in the second afterwards, m", creep.value, 0, 1e-3);
    plot.curves.push_back(std::move(ours));
  }
  Curve coulomb{"v₀²/2g(μ cos θ − sin θ)", {}, {}, true};
  for (double v = 0; v < speeds.back(); v += 0.05) coulomb.add(v, v * v / (2 * brake));
  plot.curves.push_back(std::move(coulomb));
  result.plots.push_back(std::move(plot));
  return result;
}

}  // namespace vivify::validation
