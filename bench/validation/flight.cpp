#include <cmath>
#include <numbers>

#include "bench/validation/bodies.h"
#include "bench/validation/lattice.h"
#include "bench/validation/problem.h"
#include "bench/validation/standing.h"
#include "common/rng.h"
#include "sim/control/controller.h"
#include "sim/control/rigid_motion.h"
#include "sim/settings.h"

namespace vivify::validation {
namespace {

constexpr double kStep = 1.0 / 48;
const Eigen::Vector3d kThrow(1, 4, 0);  // velocity of the centre of mass

struct Drift {
  Largest path;       // largest distance of the centre of mass from its parabola, m
  Largest force;      // sum of the internal forces over the sum of their sizes
  Largest torque;     // sum of the internal torques over the sum of force times arm
  double strain = 0;  // elastic energy beside the initial rest shape, largest, over weight times height
  Curve height;       // of the centre of mass
};

Drift fly(const sim::BodyModel& body, int steps) {
  const int d = body.dimension();
  CounterRng rng(5);
  const Vector direction =
      random_vector(body.rest->free_parameters(), body.rest->unit() == 1 ? 0.8 : 0.03, rng);
  const Vector share = coordinate_masses(body) / body.mass.sum();
  const auto centre = [&](const Vector& x) {
    Vector sum = Vector::Zero(d);
    for (Eigen::Index i = 0; i < x.size(); ++i) sum[i % d] += share[i] * x[i];
    return sum;
  };
  Vector v = random_vector(body.dofs(), 0.3, rng);
  const Vector thrown = kThrow.head(d) - centre(v);
  for (Eigen::Index i = 0; i < v.size(); i += d) v.segment(i, d) += thrown;
  Motion motion(body, flat(body.mesh.V), v, kStep, kGravity);
  const Vector start = centre(motion.x()), velocity = kThrow.head(d);
  Drift drift;
  for (int n = 1; n <= steps; ++n) {
    motion.step(std::sin(2 * std::numbers::pi * n * kStep / 0.4) * direction);
    Vector expected = start + n * kStep * velocity;
    expected[1] -= 0.5 * kGravity * kStep * kStep * n * (n + 1);
    const Vector reached = centre(motion.x());
    drift.path.add((reached - expected).norm());
    if (n % 2 == 0) drift.height.add(n * kStep, reached[1] - start[1]);
    drift.strain = std::max(drift.strain, energy(body, body.S0, motion.x()) / (body.weight * body.height));
    const Vector& f = motion.internal_forces();
    Vector arms(f.size());
    for (Eigen::Index i = 0; i < arms.size(); i += d) arms.segment(i, d) = motion.x().segment(i, d) - reached;
    const Resultant sum = resultant(arms, f, d);
    drift.force.add(sum.force.norm() / f.lpNorm<1>());
    drift.torque.add(sum.torque.norm() / arms.cwiseAbs().dot(f.cwiseAbs()));
  }
  return drift;
}

// A body that hops: its flights, each from the end of its first step without contact (friction may act until
// then).
struct Hopping {
  Largest path;        // largest distance of the centre of mass from the parabola since the flight began, m
  Largest spin;        // sum of the internal torques, of the weight times the height
  int steps = 0;       // in the air
  double changed = 0;  // largest change of ‖p‖ in a flight, over the height
};

Hopping hop(const Sample& sample, double seconds) {
  sim::BodyInput input = standing_body(sample.mesh, sample.yaml);
  input.rest_space = "full";
  input.regularizer = settings(sim::regularizer_schema(), "{rate: 1}");
  input.controller = settings(sim::controller_schema(), "{type: hop, height: 0.15, heading_deg: 90}");
  sim::World world({input}, inclined_plane(1), {{0, -kGravity, 0}, kStep});
  const sim::BodyModel& model = world.body(0).model();
  Hopping hopping;
  Eigen::Vector3d start, thrown;
  double shape = 0;
  int airborne = 0;
  while (world.time() < seconds) {
    world.step();
    const sim::StepRecord& last = record(world);
    airborne = last.contacts == 0 ? airborne + 1 : 0;
    const int n = airborne - 1;
    if (n == 0) {
      start = centre(world);
      thrown = velocity(world);
      shape = last.p_norm;
    } else if (n > 0) {
      Eigen::Vector3d expected = start + n * kStep * thrown;
      expected.y() -= 0.5 * kGravity * kStep * kStep * n * (n + 1);
      hopping.path.add((centre(world) - expected).norm());
      hopping.spin.add(last.internal_torque / (model.weight * model.height));
      hopping.changed = std::max(hopping.changed, std::abs(last.p_norm - shape) / model.height);
      ++hopping.steps;
    }
  }
  return hopping;
}

}  // namespace

Result flight(Effort) {
  constexpr int kSteps = 48;
  Result result;
  result.title = "Momentum in flight";
  result.text =
      "Thrown bodies of every model and rest space (`full`, `cage`, `examples`; figures are the "
      "largest of the three) whose rest shape changes all the time (every parameter swings with a "
      "period of 0.4 s), without contact, for one second at h = 1/48 s, with damping (β = 0.01 s). The "
      "centre of mass must follow the parabola of implicit Euler, y₀ + n h v₀ − ½ g h² n (n + 1), to "
      "the tolerance of the solver: no rest shape moves a body in the air. The internal forces, "
      "elastic and damping, and their torques sum to zero in every step. Then bodies hop on a plane "
      "for two seconds, with a controller that seeks a new rest shape in every step (`rate: 1`, so "
      "that it is still changing in the air): from the end of the first step without contact on they "
      "must fall like a stone too.";
  Plot plot{"flight", "Height of the centre of mass in flight", "t (s)", "height above the start (m)"};
  Curve parabola{"parabola of implicit Euler", {}, {}, true};
  for (int n = 0; n <= kSteps; ++n) {
    parabola.add(n * kStep, n * kStep * kThrow.y() - 0.5 * kGravity * kStep * kStep * n * (n + 1));
  }
  Table table{
      "How far the bodies change their shape: the largest elastic energy beside the initial rest "
      "shape, over weight times height.",
      {"model", "rest space", "energy"}};
  for (const Sample& sample : samples(", damping_s: 0.01")) {
    Drift worst;
    for (const std::string space : {"full", "cage", "examples"}) {
      Drift drift = fly(sample_body(sample, space), kSteps);
      worst.path.add(drift.path.value);
      worst.force.add(drift.force.value);
      worst.torque.add(drift.torque.value);
      table.rows.push_back({sample.model, space, short_number(drift.strain)});
      drift.height.name = sample.model;
      if (space == "full") plot.curves.push_back(std::move(drift.height));
    }
    result.figure(sample.model + ": distance from the parabola, m", worst.path.value, 0, 1e-12);
    result.figure(sample.model + ": sum of internal forces, relative", worst.force.value, 0, 1e-14);
    result.figure(sample.model + ": sum of internal torques, relative", worst.torque.value, 0, 1e-14);
  }
  Table controlled{
      "How much of two seconds the characters spend in the air, and how far their controller changes "
      "the rest shape there: the largest change of the norm of p in a flight, over the height.",
      {"model", "in the air (s)", "‖p‖ / height"}};
  int changing = 0;
  for (const Sample& sample : blocks(", damping_s: 0.01")) {
    const Hopping hopping = hop(sample, 2);
    controlled.rows.push_back(
        {sample.model, short_number(hopping.steps * kStep), short_number(hopping.changed)});
    result.figure(sample.model + ", hopping: distance from the parabola, m", hopping.path.value, 0, 1e-12);
    result.figure(sample.model + ", hopping: sum of internal torques over weight times height",
                  hopping.spin.value, 0, 1e-12);
    changing += hopping.changed > 0.02;
  }
  result.figure("models that change their rest shape in the air by 2 % of the height", changing, 6, 0);
  result.tables.push_back(std::move(controlled));
  plot.curves.push_back(std::move(parabola));
  result.plots.push_back(std::move(plot));
  result.tables.push_back(std::move(table));
  return result;
}

}  // namespace vivify::validation
