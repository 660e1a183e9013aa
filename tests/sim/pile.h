// What becomes of soft spheres and cards dropped into a bowl.
#pragma once

#include "bench/pile.h"

namespace vivify::sim {

struct PileResult {
  double residual = 0;         // largest relative residual of any step
  double deepest = 0;          // penetration of bodies into one another or into the bowl, at any time, m
  double deepest_at_rest = 0;  // in the last tenth of the time, m
  double fastest_at_rest = 0;  // speed of a centre in the last tenth, m/s
  int escaped = 0;             // bodies that ended below or beside the bowl
  int largest_island = 0;
};

PileResult settle_pile(const bench::Pile& pile, double seconds);

}  // namespace vivify::sim
