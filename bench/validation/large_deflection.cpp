#include <cmath>
#include <numbers>

#include "bench/validation/beam.h"
#include "bench/validation/lattice.h"
#include "bench/validation/problem.h"
#include "bench/validation/references.h"

namespace vivify::validation {
namespace {

struct Strip {
  std::string model;
  int cells;
  double slenderness;
  double tolerance;
};

std::vector<Strip> strips(bool full) {
  return {
      {"rod2d", full ? 160 : 40, 100, full ? 1e-3 : 2e-3},
      {"solid2d", full ? 8 : 4, 40, 0.01},
      {"solid2d_printed", full ? 8 : 4, 40, 0.01},
      {"shell3d", full ? 8 : 4, 10, 0.02},
      {"solid3d", full ? 4 : 2, 40, 0.02},
      {"solid3d_stvk", full ? 4 : 2, 40, 0.02},
  };
}

// A rod bent by a couple on its last edge, which follows the edge: radius and closing error of the curve.
struct Ring {
  double radius = 0, gap = 0;
};
Ring bend_to_ring(const Beam& rod) {
  const int last = static_cast<int>(rod.body.mesh.V.rows()) - 1;
  const double edge = (rod.X.segment<2>(2 * last) - rod.X.segment<2>(2 * last - 2)).norm();
  Vector x = rod.X;
  constexpr int kIncrements = 60, kFollow = 8;
  for (int step = 1; step <= kIncrements; ++step) {
    const double moment = 2 * std::numbers::pi * rod.EI / rod.length * step / kIncrements;
    for (int i = 0; i < kFollow; ++i) {
      const Eigen::Vector2d along = (x.segment<2>(2 * last) - x.segment<2>(2 * last - 2)).normalized();
      Vector force = Vector::Zero(x.size());
      force.segment<2>(2 * last) = moment / edge * Eigen::Vector2d(-along.y(), along.x());
      force.segment<2>(2 * last - 2) = -force.segment<2>(2 * last);
      x = equilibrium(rod.body, x, force, rod.held);
    }
  }
  double top = 0;
  for (int i = 0; i <= last; ++i) top = std::max(top, x[2 * i + 1]);
  return {top / 2, x.segment<2>(2 * last).norm()};
}

}  // namespace

Result large_deflection(Effort effort) {
  Result result;
  result.title = "Large deflection of a cantilever";
  result.text =
      "A dead load P at the tip, across the beam at rest, α = P L²/EI. Reference: the inextensible elastica, "
      "computed twice, by shooting with Runge–Kutta and by elliptic integrals (they agree to 1e-8, and "
      "confirm the "
      "remembered figures 0.302, 0.670 with shortening 0.329, and 0.811). EI is the bending stiffness that "
      "the same "
      "mesh shows under a small load, so that locking (see the cantilever) does not hide the large "
      "rotations. The "
      "strip of Sze et al. 2004 (E = 1.2e6, ν = 0, 10 × 1 × 0.1, P = 4, hence α = 4; there w = 6.698, u = "
      "3.286) "
      "is this elastica at α = 4 up to its stretch: ours are given for L = 10, with the stiffness of the "
      "model itself, "
      "8/3 k_b per width, and are a little stiff for the same reason as the clamped strip above. An end "
      "moment "
      "2π EI/L closes a rod to a ring.";
  for (const double alpha : {1.0, 4.0, 10.0}) {
    const TipMotion shot = elastica(alpha), exact = elastica_integrals(alpha);
    result.figure("elastica, α = " + short_number(alpha) + ": shooting beside elliptic integrals, across",
                  shot.across, exact.across, 1e-8);
    result.figure("elastica, α = " + short_number(alpha) + ": shooting beside elliptic integrals, back",
                  shot.back, exact.back, 1e-8);
  }
  Plot plot{"large_deflection", "Large deflection of a cantilever", "P L²/EI", "motion of the tip over L"};
  Curve across{"elastica: across", {}, {}, true}, back{"elastica: back", {}, {}, true};
  for (double alpha = 0.25; alpha <= 10; alpha += 0.25) {
    const TipMotion tip = elastica_integrals(alpha);
    across.add(alpha, tip.across);
    back.add(alpha, tip.back);
  }
  plot.curves = {across, back};
  for (const Strip& strip : strips(effort == Effort::full)) {
    const Beam beam = make_beam(strip.model, strip.cells, strip.slenderness);
    const double L = beam.length, small = 0.01 * beam.EI / (L * L);
    const Vector slightly = equilibrium(beam.body, beam.X, -small * beam.tip_force(1), beam.held);
    const double EI = small * L * L * L / (-3 * beam.tip_motion(slightly, 1));
    Curve ours_across{strip.model + ": across"}, ours_back{strip.model + ": back"};
    Vector x = slightly;
    for (double alpha = 0.5; alpha <= 10; alpha += 0.5) {
      x = equilibrium(beam.body, x, -alpha * EI / (L * L) * beam.tip_force(1), beam.held);
      const double w = -beam.tip_motion(x, 1) / L, u = -beam.tip_motion(x, 0) / L;
      if (alpha != std::floor(alpha)) continue;
      ours_across.add(alpha, w);
      ours_back.add(alpha, u);
      if (alpha != 1 && alpha != 4 && alpha != 10) continue;
      const TipMotion reference = elastica_integrals(alpha);
      const std::string name = strip.model + ", α = " + short_number(alpha);
      result.figure(name + ": across", w, reference.across, strip.tolerance);
      result.figure(name + ": back", u, reference.back, 2 * strip.tolerance);
    }
    plot.curves.push_back(std::move(ours_across));
    plot.curves.push_back(std::move(ours_back));
    if (strip.model == "shell3d") {
      const Vector sze = equilibrium(beam.body, x, -4 * beam.EI / (L * L) * beam.tip_force(1), beam.held);
      result.figure("strip of Sze et al.: w", -10 * beam.tip_motion(sze, 1) / L, 6.698, 0.02);
      result.figure("strip of Sze et al.: u", -10 * beam.tip_motion(sze, 0) / L, 3.286, 0.04);
    }
  }
  result.plots.push_back(std::move(plot));

  const Beam rod = make_beam("rod2d", effort == Effort::full ? 120 : 40, 1000);
  const Ring ring = bend_to_ring(rod);
  result.figure("rod under 2π EI/L: radius over L", ring.radius / rod.length, 1 / (2 * std::numbers::pi),
                3e-3);
  result.figure("rod under 2π EI/L: gap between its ends over L", ring.gap / rod.length, 0, 0.02);
  return result;
}

}  // namespace vivify::validation
