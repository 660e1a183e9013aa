#include <cmath>
#include <numbers>

#include "bench/validation/lattice.h"
#include "bench/validation/problem.h"
#include "bench/validation/standing.h"

namespace vivify::validation {
namespace {

constexpr double kInner = 0.85, kOuter = 1.15;  // m

// Voussoir `index` of `count` of a half circle on y = 0, of 2 by 2 cells.
SimMesh voussoir(int index, int count) {
  SimMesh mesh = rectangle(2, 2, 1, 1);
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
    const double along = mesh.V(v, 0), across = mesh.V(v, 1) + 0.5;  // each from 0 to 1
    const double angle = std::numbers::pi * (1 - (index + along) / count),
                 r = kInner + across * (kOuter - kInner);
    mesh.V.row(v) << r * std::cos(angle), r * std::sin(angle);
  }
  return mesh;
}

Standing stand(int count, double friction, double h) {
  std::vector<sim::BodyInput> bodies;
  for (int i = 0; i < count; ++i) {
    bodies.push_back(standing_body(
        voussoir(i, count),
        "{type: solid2d, density: 2000, stiffness: 2e7, volume_stiffness: 2e7, damping_s: 0.01}",
        "stone" + std::to_string(i)));
  }
  sim::World world(bodies, inclined_plane(friction), {{0, -kGravity, 0}, h});
  return watch_standing(world, h, count / 2);
}

}  // namespace

Result arch(Effort effort) {
  Result result;
  result.title = "An arch of loose stones";
  result.text =
      "A half circle of soft stones (`solid2d`), 0.3 m thick on a radius of 1 m, without mortar: it stands "
      "by "
      "contact and friction (μ = 1 between the stones and under the feet) alone. The thinnest half circle "
      "that stands has 0.1075 of its radius (Milankovitch 1907), so this one must stand. It settles in the "
      "first second, and "
      "then no centre of a stone may move by more than 1 mm in 5 s.";
  Plot plot{"arch", "Sinking of the keystone", "t (s)", "sinking (mm)"};
  const std::vector<int> counts =
      effort == Effort::full ? std::vector<int>{5, 7, 9, 11} : std::vector<int>{7};
  Table table{"The keystone sinks while the joints close and the stones are squeezed.",
              {"stones", "sunk (mm)", "deepest penetration (mm)"}};
  for (const int count : counts) {
    const Standing standing = stand(count, 1, 0.01);
    result.figure(std::to_string(count) + " stones: largest motion of a centre in 5 s, m", standing.drift, 0,
                  1e-3);
    result.figure(std::to_string(count) + " stones: sinking of the keystone, m", standing.sunk, 0, 0.02);
    table.rows.push_back(
        {std::to_string(count), short_number(1e3 * standing.sunk), short_number(1e3 * standing.penetration)});
    Curve keystone{std::to_string(count) + " stones"};
    for (std::size_t i = 0; i < standing.height.x.size(); ++i)
      keystone.add(standing.height.x[i], 1e3 * (standing.start - standing.height.y[i]));
    plot.curves.push_back(std::move(keystone));
  }
  result.plots.push_back(std::move(plot));
  result.tables.push_back(std::move(table));
  return result;
}

}  // namespace vivify::validation
