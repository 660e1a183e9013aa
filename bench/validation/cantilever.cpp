#include <cmath>

#include "bench/validation/beam.h"
#include "bench/validation/convergence.h"
#include "bench/validation/problem.h"
#include "bench/validation/references.h"

namespace vivify::validation {
namespace {

struct Study {
  std::string model;
  std::vector<double> cells;
  double slenderness;
  double limit_tolerance;  // of the limits of fine meshes
};

std::vector<Study> studies(bool full) {
  const std::vector<double> plane =
      full ? std::vector<double>{2, 4, 8, 16, 32} : std::vector<double>{2, 4, 8};
  const std::vector<double> space = full ? std::vector<double>{2, 4, 6, 8, 12} : std::vector<double>{2, 4, 6};
  return {
      {"rod2d", full ? std::vector<double>{5, 10, 20, 40, 80} : std::vector<double>{10, 20, 40}, 20, 1e-3},
      {"solid2d", plane, 20, 0.01},
      {"solid2d_printed", plane, 20, 0.01},
      {"shell3d", full ? std::vector<double>{2, 4, 8, 16} : std::vector<double>{2, 4, 8}, 10, 0.03},
      {"solid3d", space, 10, 0.03},
      {"solid3d_stvk", space, 10, 0.03},
  };
}

// Stiffness of the model over that of beam theory, from three experiments.
struct Stiffening {
  double tip = 0, self_weight = 0, frequency = 0;
};

Stiffening measure(const Beam& beam) {
  const double L = beam.length, EI = beam.EI;
  Stiffening result;
  const double F = 0.01 * EI / (L * L);
  const Vector tip = equilibrium(beam.body, beam.X, -F * beam.tip_force(1), beam.held);
  result.tip = (F * std::pow(L, 3) / (3 * EI) + F * L / beam.GA) / -beam.tip_motion(tip, 1);

  const double g = 0.08 * EI / (std::pow(L, 3) * beam.line_density), w = g * beam.line_density;
  const Vector bent = equilibrium(beam.body, beam.X, -g * beam.weight(1), beam.held);
  result.self_weight =
      (w * std::pow(L, 4) / (8 * EI) + w * L * L / (2 * beam.GA)) / -beam.tip_motion(bent, 1);

  // Dunkerley: bending and shear add their 1/ω².
  const double bending = cantilever_frequency() * std::sqrt(EI / beam.line_density) / (L * L);
  const double shear = std::acos(-1) / (2 * L) * std::sqrt(beam.GA / beam.line_density);
  const double expected2 = 1 / (1 / (bending * bending) + 1 / (shear * shear));
  result.frequency = std::pow(lowest_frequency(beam.body, beam.held), 2) / expected2;
  return result;
}

}  // namespace

Result cantilever(Effort effort) {
  Result result;
  result.title = "Cantilever: small deflections and the first frequency";
  result.text =
      "A beam clamped at one end. References: tip load F L³/(3 EI), own weight w L⁴/(8 EI), first frequency "
      "(3.516/2π) √(EI/(ρA L⁴)) with 3.516 from cos x cosh x = −1, solved by bisection; each with the shear "
      "of "
      "Timoshenko's beam (5/6 G A) for solids. The figures are the bending stiffness that each experiment "
      "sees, "
      "over EI.\n\n"
      "EI of each model is that of its small strains: `rod2d` Y t³/12; `solid2d` and `solid2d_printed` plane "
      "stress with Y (μ = k_l/2, λ = k_a); `shell3d` 8/3 k_b per width (equilateral hinges make a plate with "
      "D = 3 k_b and Poisson's ratio −1/3, and a strip bends with D (1 − 1/9)); `solid3d_stvk` Y; `solid3d` "
      "the "
      "Young's modulus of its lattice along the beam, which is measured by uniform strains and agrees with "
      "the "
      "sum over its edges: five-tetrahedra cubes have C11 = 8/9 k_l + k_v, C12 = 2/9 k_l + k_v, C44 = 2/9 "
      "k_l "
      "(Zener ratio 2/3, where directions alike would have 8/15, 4/15, 4/15 beside k_v).\n\n"
      "Linear triangles and tetrahedra lock in bending: with n cells over the height they are too stiff by "
      "about 2.4/n² (triangles, n ≥ 2). The order is measured on the last three meshes, and the limit "
      "extrapolated. The strip of `shell3d` is stiffer by 2 % in the limit because its clamp forbids the "
      "transverse curvature of Poisson's ratio −1/3 near it; this fades with the slenderness (second table).";
  Plot plot{"cantilever_convergence",
            "Cantilever: error of the bending stiffness (tip load)",
            "cells over the height (rod: 1/10 of its edges; shell: over the width)",
            "|EI of the mesh / EI − 1|",
            true,
            true};
  Table table{"Bending stiffness over EI.",
              {"model", "cells", "degrees of freedom", "tip load", "own weight", "frequency²"}};
  for (const Study& study : studies(effort == Effort::full)) {
    std::vector<double> tip, self_weight, frequency;
    Curve curve{study.model};
    for (const double cells : study.cells) {
      const Beam beam = make_beam(study.model, static_cast<int>(cells), study.slenderness);
      const Stiffening stiffening = measure(beam);
      tip.push_back(stiffening.tip);
      self_weight.push_back(stiffening.self_weight);
      frequency.push_back(stiffening.frequency);
      curve.add(study.model == "rod2d" ? cells / 10 : cells, std::abs(stiffening.tip - 1));
      table.rows.push_back({study.model, short_number(cells), std::to_string(beam.body.dofs()),
                            short_number(stiffening.tip), short_number(stiffening.self_weight),
                            short_number(stiffening.frequency)});
    }
    plot.curves.push_back(std::move(curve));
    const auto limit = [&](const std::vector<double>& v) { return converge(study.cells, v).limit; };
    result.figure(study.model + ": tip load, limit", limit(tip), 1, study.limit_tolerance);
    result.figure(study.model + ": own weight, limit", limit(self_weight), 1, study.limit_tolerance);
    result.figure(study.model + ": frequency², limit", limit(frequency), 1, study.limit_tolerance);
    // Borders have half of the hinges, so shells converge with first order, and coarse tetrahedra lie
    // between.
    if (study.model.find("2d") != std::string::npos) {
      result.figure(study.model + ": order of convergence", converge(study.cells, tip).order, 2, 0.1);
    }
  }
  Curve slope{"second order", {}, {}, true};
  for (const double n : {0.5, 32.0}) slope.add(n, 2.44 / (n * n));
  plot.curves.push_back(std::move(slope));
  result.plots.push_back(std::move(plot));
  result.tables.push_back(std::move(table));

  Table strips{"Shell strips, limit of the stiffness under a tip load over 8/3 k_b per width.",
               {"length over width", "stiffness"}};
  std::vector<double> excess;
  for (const double slenderness :
       effort == Effort::full ? std::vector<double>{10, 15, 20} : std::vector<double>{10, 20}) {
    std::vector<double> n = {2, 4, 8}, v;
    for (const double cells : n)
      v.push_back(measure(make_beam("shell3d", static_cast<int>(cells), slenderness)).tip);
    excess.push_back(converge(n, v).limit);
    strips.rows.push_back({short_number(slenderness), short_number(excess.back())});
  }
  result.figure("shell3d, 20 times as long as wide: tip load, limit", excess.back(), 1, 0.015);
  result.tables.push_back(std::move(strips));

  const Beam cubes = make_beam("solid3d", 2, 5);
  const Matrix C = uniform_strain_stiffness(cubes.body);
  const double mu = 1.2e6 / 2.6, lambda = 1.2e6 * 0.3 / (1.3 * 0.4), kl = 15 * mu / 4, kv = lambda - mu;
  result.figure("solid3d: C11 of the lattice, Pa", C(0, 0), 8 * kl / 9 + kv, 1e-5);
  result.figure("solid3d: C12 of the lattice, Pa", C(0, 1), 2 * kl / 9 + kv, 1e-5);
  result.figure("solid3d: C44 of the lattice, Pa", C(5, 5), 2 * kl / 9, 1e-5);
  return result;
}

}  // namespace vivify::validation
