// Soft spheres and cards above a bowl.
#pragma once

#include <ostream>

#include "sim/world.h"

namespace vivify::bench {

inline constexpr double kPileRadius = 0.05;  // of the spheres, m
inline constexpr double kBowlRim = 0.72;     // m from the axis
double bowl_height(double r);                // of the bowl at a distance from its axis, m

struct Pile {
  int spheres = 0, cards = 0;
  double speed = 0;          // downwards at the start, m/s
  double stiffness = 40000;  // of the spheres, Pa
};

// How a failing case of the tests is printed.
inline void PrintTo(const Pile& pile, std::ostream* out) {
  *out << pile.spheres << " spheres and " << pile.cards << " cards at " << pile.speed << " m/s";
}

sim::World pile_world(const Pile& pile, double h);
// As many spheres side by side, too far apart to touch, each on the ground.
sim::World apart_world(int spheres, double h);

}  // namespace vivify::bench
