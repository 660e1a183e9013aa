#include <cmath>
#include <functional>
#include <numbers>

#include "bench/validation/beam.h"
#include "bench/validation/convergence.h"
#include "bench/validation/lattice.h"
#include "bench/validation/problem.h"
#include "bench/validation/references.h"

namespace vivify::validation {
namespace {

constexpr double kPi2 = std::numbers::pi * std::numbers::pi;

bool stable(const sim::BodyModel& body, const Vector& x, const std::vector<bool>& held) {
  sim::SymmetricMatrix K(*body.pattern);
  stiffness(body, body.S0, x, K);
  hold(held, body.dimension(), 1, K);
  return sim::LinearSolver(*body.pattern).factorize(K);
}

// The load at which the straight state loses its stability, by bisection in [0, high].
double critical(double high, const std::function<bool(double)>& stable_at) {
  double low = 0;
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    (stable_at(middle) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

// A rod that is clamped at one end and free at the other, under a force on its end.
double clamped_free(const Beam& rod) {
  const double euler = kPi2 * rod.EI / (4 * rod.length * rod.length);
  return critical(3 * euler, [&](double P) {
    return stable(rod.body, equilibrium(rod.body, rod.X, -P * rod.tip_force(0), rod.held), rod.held);
  });
}

// A clamped column under its own weight: ρ A g L³.
double self_weight(const Beam& rod) {
  const double expected = self_weight_buckling() * rod.EI / (rod.line_density * std::pow(rod.length, 3));
  const double g = critical(3 * expected, [&](double gravity) {
    return stable(rod.body, equilibrium(rod.body, rod.X, -gravity * rod.weight(0), rod.held), rod.held);
  });
  return g * rod.line_density * std::pow(rod.length, 3);
}

// A rod of length 1 between two hinges that approach each other; the force on a hinge.
double pinned(int edges, double bending, double stretch) {
  const sim::BodyModel rod =
      body(chain(edges, 0, 1), "{type: rod2d, stiffness: " + std::to_string(stretch) +
                                   ", bending_stiffness: " + std::to_string(bending) + "}");
  const Vector X = flat(rod.mesh.V);
  std::vector<bool> held(static_cast<std::size_t>(edges + 1), false);
  held.front() = held.back() = true;
  const double shortening = critical(3 * kPi2 * bending / (4 * stretch),
                                     [&](double part) { return stable(rod, (1 - part) * X, held); });
  return -gradient(rod, rod.S0, (1 - shortening) * X)[2 * edges];
}

// Linear buckling of a clamped beam of any model under a force on its end: the smallest P with (K + P dK/dP)
// φ = 0, where dK/dP is that of a small load.
double linear_buckling(const Beam& beam) {
  const double small = 0.01 * kPi2 * beam.EI / (4 * beam.length * beam.length);
  const int d = beam.body.dimension();
  sim::SymmetricMatrix K(*beam.body.pattern), loaded(*beam.body.pattern);
  stiffness(beam.body, beam.body.S0, beam.X, K);
  stiffness(beam.body, beam.body.S0, equilibrium(beam.body, beam.X, -small * beam.tip_force(0), beam.held),
            loaded);
  hold(beam.held, d, 1, K);
  hold(beam.held, d, 1, loaded);
  sim::LinearSolver solver(*beam.body.pattern);
  if (!solver.factorize(K)) throw Error(ErrorKind::numerical, "the beam is not held");
  Vector mode = beam.tip_force(1);
  double share = 0;  // small load over critical load
  for (int i = 0; i < 20; ++i) {
    const Vector change = K * mode - loaded * mode, next = solver.solve(change);
    share = mode.dot(change) / mode.dot(Vector(K * mode));
    mode = next / next.norm();
  }
  return small / share;
}

}  // namespace

Result buckling(Effort effort) {
  const bool full = effort == Effort::full;
  Result result;
  result.title = "Buckling";
  result.text =
      "Critical loads. References: Euler's π² EI/(4 L²) clamped at one end and π² EI/L² between hinges; a "
      "column under "
      "its own weight, ρ A g L³ = 7.837 EI (computed here twice, by shooting on θ″ = −λ s θ and from the "
      "first root of "
      "the Bessel function of order −1/3: λ = 9/4 j²). Rods: bisection on the load until the stiffness "
      "matrix of the "
      "straight, compressed state stops being positive definite. All models: linear buckling from the change "
      "of "
      "the stiffness matrix under a small load, with Euler's load softened by shear for solids (1/P = "
      "1/P_Euler + "
      "1/GA).\\n\\n"
      "With `bending_scaling: paper`, the printed weight T̄ of a joint instead of 1/T̄, the critical load "
      "falls by a "
      "factor of 4 for every halving of the edges: the printed bending vanishes under refinement. The "
      "default "
      "`consistent` converges with second order.";
  result.figure("self-weight: shooting beside Bessel", self_weight_buckling(), self_weight_buckling_bessel(),
                1e-9);

  const std::vector<double> edges =
      full ? std::vector<double>{10, 20, 40, 80, 160} : std::vector<double>{10, 20, 40};
  Plot plot{"buckling", "Critical load of rods against resolution",
            "edges",    "critical load over reference",
            true,       true};
  Curve one{"reference", {}, {}, true};
  for (const double n : {edges.front(), edges.back()}) one.add(n, 1);
  Curve euler{"clamped, consistent"}, hinged{"hinged, consistent"}, column{"own weight, consistent"},
      printed{"clamped, paper"};
  for (const double n : edges) {
    const int cells = static_cast<int>(n);
    const Beam rod = make_beam("rod2d", cells, 1000);
    euler.add(n, clamped_free(rod) / (kPi2 * rod.EI / (4 * rod.length * rod.length)));
    column.add(n, self_weight(rod) / (self_weight_buckling() * rod.EI));
    hinged.add(n, pinned(cells, 1, 1e6) / kPi2);
    // The printed rod bends with k_b T̄²; relative to its own value on the coarsest mesh.
    const Beam paper = make_beam("rod2d", cells, 1000, "paper");
    printed.add(n, linear_buckling(paper));
  }
  const double coarse = printed.y.front();
  for (double& value : printed.y) value /= coarse;
  result.figure("rod, clamped: limit over π² EI/(4 L²)", converge(edges, euler.y).limit, 1, 1e-4);
  result.figure("rod, hinged: limit over π² EI/L²", converge(edges, hinged.y).limit, 1, 1e-4);
  result.figure("rod, own weight: limit over 7.837 EI", converge(edges, column.y).limit, 1, 1e-3);
  result.figure("rod, clamped: order of convergence", converge(edges, euler.y).order, 2, 0.05);
  result.figure("rod, hinged: order of convergence", converge(edges, hinged.y).order, 2, 0.05);
  const std::size_t last = edges.size() - 1;
  result.figure("rod, `bending_scaling: paper`: power of the edge length with which it vanishes",
                std::log2(printed.y[last - 1] / printed.y[last]), 2, 0.05);
  const auto strip = [](int rows) { return linear_buckling(make_beam("shell3d", rows, 10, "paper")); };
  result.figure("shell3d, `bending_scaling: paper`: power of the edge length with which it vanishes",
                std::log2(strip(4) / strip(8)), 2, 0.05);
  plot.curves = {one, euler, hinged, column, printed};
  result.plots.push_back(std::move(plot));

  struct Study {
    std::string model;
    std::vector<double> cells;
    double slenderness, tolerance;
  };
  const std::vector<double> plane = full ? std::vector<double>{2, 4, 8, 16} : std::vector<double>{2, 4, 8};
  const std::vector<double> space = full ? std::vector<double>{2, 4, 6, 8} : std::vector<double>{2, 4, 6};
  const std::vector<Study> studies = {
      {"rod2d", {10, 20, 40}, 1000, 1e-3}, {"solid2d", plane, 20, 0.01}, {"solid2d_printed", plane, 20, 0.01},
      {"shell3d", {2, 4, 8}, 10, 0.03},    {"solid3d", space, 10, 0.03}, {"solid3d_stvk", space, 10, 0.03}};
  Plot models{"buckling_models",
              "Linear buckling of clamped beams",
              "cells over the height (rod: edges/10)",
              "critical load over Euler's",
              true,
              true};
  for (const Study& study : studies) {
    Curve curve{study.model};
    for (const double cells : study.cells) {
      const Beam beam = make_beam(study.model, static_cast<int>(cells), study.slenderness);
      const double bend = kPi2 * beam.EI / (4 * beam.length * beam.length);
      const double expected = 1 / (1 / bend + 1 / beam.GA);
      curve.add(study.model == "rod2d" ? cells / 10 : cells, linear_buckling(beam) / expected);
    }
    result.figure(study.model + ": linear buckling, limit over Euler's load",
                  converge(study.cells, curve.y).limit, 1, study.tolerance);
    models.curves.push_back(std::move(curve));
  }
  Curve line{"reference", {}, {}, true};
  for (const double n : {1.0, 16.0}) line.add(n, 1);
  models.curves.push_back(std::move(line));
  result.plots.push_back(std::move(models));
  return result;
}

}  // namespace vivify::validation
