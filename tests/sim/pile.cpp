#include "tests/sim/pile.h"

#include <algorithm>
#include <cmath>

#include "sim/control/rigid_motion.h"

namespace vivify::sim {

PileResult settle_pile(const bench::Pile& pile, double seconds) {
  const double h = 0.01;
  World world = bench::pile_world(pile, h);
  PileResult result;
  const int steps = static_cast<int>(seconds / h);
  for (int step = 0; step < steps; ++step) {
    world.step();
    const bool last = step >= 0.9 * steps;
    for (auto record = world.records().end() - world.body_count(); record != world.records().end();
         ++record) {
      result.residual = std::max(result.residual, record->residual_rel);
      result.deepest = std::max(result.deepest, record->max_penetration);
      if (last) {
        result.deepest_at_rest = std::max(result.deepest_at_rest, record->max_penetration);
        result.fastest_at_rest = std::max(result.fastest_at_rest, record->vel.norm());
      }
    }
    for (const std::vector<int>& island : world.islands())
      result.largest_island = std::max(result.largest_island, static_cast<int>(island.size()));
  }
  for (int b = 0; b < world.body_count(); ++b) {
    const Eigen::Vector3d centre = centre_of_mass(world.body(b).model().mass, world.body(b).x());
    const double r = std::hypot(centre.x(), centre.z());
    if (r > bench::kBowlRim || centre.y() < bench::bowl_height(r)) ++result.escaped;
  }
  return result;
}

}  // namespace vivify::sim
