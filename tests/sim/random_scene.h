// Scenes that nobody would make: any model and rest space, meshes with slivers, stiffness over four decades,
// drops, twists, inverted elements, violent goals. Everything follows from the seed.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/sim/fixtures.h"

namespace vivify::sim {

struct RandomScene {
  std::string text;  // what it is, in one line
  BodyInput body;
  WorldSettings settings;
  std::vector<Collider> colliders;
  Vector x, v;  // where it starts
  int steps = 0;
};
RandomScene random_scene(std::uint64_t seed);

struct RandomRun {
  std::vector<StepRecord> records;  // of the steps that were simulated
  Vector x, v;                      // after them
  double weight = 0, height = 0;    // of the body
  std::string error, hint;          // empty when all steps were simulated
  std::vector<double> seconds;      // of each step
};
// Simulates until the end, or until an Error(numerical); other errors pass through.
RandomRun simulate(RandomScene scene);

// Over seeds: the first in random_scene_test.cpp, which are run always, all others in
// random_scene_slow_test.cpp.
class RandomScenes : public ::testing::TestWithParam<std::uint64_t> {};

}  // namespace vivify::sim
