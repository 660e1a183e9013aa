#include <algorithm>
#include <cmath>

#include "bench/validation/lattice.h"
#include "bench/validation/problem.h"
#include "bench/validation/standing.h"
#include "sim/control/controller.h"
#include "sim/control/rigid_motion.h"

namespace vivify::validation {
namespace {

constexpr double kStep = 1.0 / 200;

struct Impact {
  Largest pull;         // force of the ground towards itself, of the weight
  Largest rise;         // of the mechanical energy in a step, of that at the start
  double largest = 0;   // force of the ground, of the weight
  double lift = 0;      // height of the lowest point after the first contact, m
  int separations = 0;  // steps in which the ground was left
  Curve force;          // over time
};

double lowest(const sim::World& world) {
  return sim::lowest_height(world.body(0).x(), world.body(0).model().dimension());
}

// Kinetic, elastic and gravitational, and that of the normal forces.
double mechanical_energy(const sim::World& world) {
  const sim::StepRecord& last = record(world);
  const sim::BodyModel& model = world.body(0).model();
  double energy = last.kinetic + last.elastic + mass(world) * kGravity * last.com.y();
  for (const sim::ContactMemory& contact : world.body(0).state().contacts) {
    if (contact.touching)
      energy += contact.normal_force * std::sqrt(contact.normal_force / model.contact.normal_stiffness) / 3;
  }
  return energy;
}

// The force of the ground from the change of momentum alone.
Impact fall(const sim::BodyInput& input, double friction, double seconds) {
  sim::World world({input}, inclined_plane(friction), {{0, -kGravity, 0}, kStep});
  const double weight = world.body(0).model().weight;
  Impact impact;
  double before = input.velocity.y(), energy = 0, start = 0;
  bool touched = false, pressed = false;
  while (world.time() < seconds) {
    world.step();
    const double now = velocity(world).y();
    const double force = mass(world) * ((now - before) / kStep + kGravity) / weight;
    before = now;
    impact.pull.add(std::max(0.0, -force));
    impact.largest = std::max(impact.largest, force);
    const double held = mechanical_energy(world);
    if (world.steps() == 1) {
      start = held;
    } else {
      impact.rise.add(std::max(0.0, held - energy) / start);
    }
    energy = held;
    const bool presses = force > 1e-6;
    if (pressed && !presses) ++impact.separations;
    pressed = presses;
    touched = touched || presses;
    if (touched) impact.lift = std::max(impact.lift, lowest(world));
    impact.force.add(world.time(), force);
  }
  return impact;
}

// A platform that lifts a resting body by kLift within kLifting from kRest on.
constexpr double kRest = 0.5, kLift = 1, kLifting = 0.5;

double lifted(double t) {  // height of the platform, as RigidPath goes from key to key
  const double s = std::clamp((t - kRest) / kLifting, 0.0, 1.0);
  return kLift * s * s * (3 - 2 * s);
}

struct Throw {
  double release = 0;  // time since the start, s
  double apex = 0;     // highest rise of the centre of mass, m
  Largest pull;        // force of the platform towards itself, of the weight
};

// A rigid body flies when the platform slows down faster than it falls.
Throw rigid_throw() {
  const double s = 0.5 + kGravity * kLifting * kLifting / (12 * kLift);
  const double speed = 6 * kLift * s * (1 - s) / kLifting, t = kRest + s * kLifting;
  return {t, lifted(t) + speed * speed / (2 * kGravity), {}};
}

Throw thrown(const Sample& sample, double h) {
  const sim::RigidPath path(
      {{kRest, {0, 0, 0}, {0, 0, 0}, {}}, {kRest + kLifting, {0, kLift, 0}, {0, 0, 0}, {}}}, false);
  std::vector<sim::Collider> platform;
  platform.emplace_back("platform",
                        sim::make_collider_shape(settings(sim::collider_shape_schema(), "{type: plane}"), {}),
                        1, path);
  sim::World world({standing_body(sample.mesh, sample.yaml)}, std::move(platform), {{0, -kGravity, 0}, h});
  const double start = centre(world).y(), weight = world.body(0).model().weight;
  Throw thrown;
  double before = 0;
  while (world.time() < kRest + kLifting + 0.25) {
    world.step();
    const double now = velocity(world).y(), force = mass(world) * ((now - before) / h + kGravity) / weight;
    before = now;
    thrown.pull.add(std::max(0.0, -force));
    if (thrown.release == 0 && world.time() > kRest + 0.5 * kLifting && record(world).contacts == 0)
      thrown.release = world.time();
    thrown.apex = std::max(thrown.apex, centre(world).y() - start);
  }
  return thrown;
}

}  // namespace

Result impact(Effort effort) {
  Result result;
  result.title = "Impact without sticking";
  result.text =
      "Blocks of every model, tilted by 8°, dropped at 2 m/s on a plane without friction. The force of "
      "the ground, taken from the change of momentum alone (m (v₊ − v) / h + m g), must never pull, "
      "neither at the impact nor at the release, and the energy (kinetic, elastic, of the weight and "
      "of the normal forces) must not rise in any step. Then a platform lifts the blocks by 1 m within "
      "0.5 s: they must leave it when it slows down faster than they fall (within 5 %: the last of the "
      "contact layer is crossed slowly), and rise as high as a rigid body (within 1 %). Last come "
      "controlled bodies on a ground with μ = 1, whose hop controllers would gain by holding on to it. "
      "h = 1/200 s.";
  const double seconds = effort == Effort::full ? 1.5 : 0.6;
  Plot plot{"impact", "Force of the ground during an impact", "t (s)", "force / weight"};
  Table table{
      "Largest force of the ground over the weight, times that the ground was left, and the height "
      "that the lowest point reached after the first touch.",
      {"body", "force / weight", "times left", "height (m)"}};
  for (const Sample& sample : blocks()) {
    sim::BodyInput input = standing_body(inclined(moved(sample.mesh, {0, 0.2, 0}), 8), sample.yaml);
    input.velocity = {0, -2, 0};
    Impact dropped = fall(input, 0, seconds);
    result.figure(sample.model + ": largest pull of the ground over the weight", dropped.pull.value, 0, 1e-8);
    result.figure(sample.model + ": largest rise of the energy in a step, relative", dropped.rise.value, 0,
                  1e-10);
    table.rows.push_back({sample.model, short_number(dropped.largest), std::to_string(dropped.separations),
                          short_number(dropped.lift)});
    dropped.force.name = sample.model;
    plot.curves.push_back(std::move(dropped.force));
  }
  const Throw rigid = rigid_throw();
  for (const Sample& sample : blocks(", damping_s: 0.01")) {
    const Throw body = thrown(sample, kStep);
    result.figure(sample.model + ", thrown: time of release, s", body.release - kRest, rigid.release - kRest,
                  0.05);
    result.figure(sample.model + ", thrown: rise, m", body.apex, rigid.apex, 0.01);
    result.figure(sample.model + ", thrown: largest pull of the platform over the weight", body.pull.value, 0,
                  1e-8);
  }
  for (const Sample& sample : blocks()) {
    if (sample.model != "solid2d" && sample.model != "solid3d") continue;
    sim::BodyInput input = standing_body(sample.mesh, sample.yaml);
    input.rest_space = "full";
    input.controller = settings(sim::controller_schema(), "{type: hop, height: 0.1, heading_deg: 90}");
    const Impact hopping = fall(input, 1, seconds);
    result.figure(sample.model + ", hopping: largest pull of the ground over the weight", hopping.pull.value,
                  0, 1e-8);
    table.rows.push_back({sample.model + ", hopping", short_number(hopping.largest),
                          std::to_string(hopping.separations), short_number(hopping.lift)});
  }
  result.plots.push_back(std::move(plot));
  result.tables.push_back(std::move(table));
  return result;
}

}  // namespace vivify::validation
