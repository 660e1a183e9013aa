// Soft spheres and cards dropped into a bowl.
#pragma once

#include "sim/world.h"

namespace vivify::sim {

inline constexpr double kPileRadius = 0.05;  // of the spheres, m

struct Pile {
  int spheres = 0, cards = 0;
  double speed = 0;  // downwards, m/s
  double seconds = 0;
};

World pile_world(const Pile& pile, double h);

struct PileResult {
  double residual = 0;         // largest relative residual of any step
  double deepest = 0;          // penetration of spheres into one another or into the bowl, at any time, m
  double deepest_at_rest = 0;  // in the last tenth of the time, m
  double fastest_at_rest = 0;  // speed of a centre in the last tenth, m/s
  int escaped = 0;             // bodies that ended below or beside the bowl
  int largest_island = 0;
};

PileResult settle_pile(const Pile& pile);

}  // namespace vivify::sim
