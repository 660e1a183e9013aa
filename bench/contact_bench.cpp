// What contact costs, as ratios from one run: contact points of a hopper, a pile of spheres beside spheres
// that do not touch, and two threads beside one.
//   contact_bench
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "bench/bodies.h"
#include "bench/pile.h"
#include "bench/timing.h"
#include "common/memory.h"
#include "common/parallel.h"

using namespace vivify;
using namespace vivify::bench;

namespace {

constexpr double kStep = 0.01;
constexpr int kRepetitions = 5;

// Wall time per step of the next `steps` steps, s.
double step_seconds(sim::World& world, int steps) {
  const auto begin = std::chrono::steady_clock::now();
  for (int step = 0; step < steps; ++step) world.step();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() / steps;
}

// A hopping box that touches with `points` of its points.
sim::World hopper(int points) {
  SimMesh mesh = box(3, 6, 2, 0.1);
  const std::string model = lively_model("solid3d", mesh);
  sim::BodyInput input = body_input("hopper", mesh, model, "{type: hop, height: 0.2, pace: 0.3}");
  input.contact_points.vertices.conservativeResize(std::min(points, input.contact_points.size()),
                                                   Eigen::NoChange);
  input.contact_points.weights.conservativeResize(input.contact_points.vertices.rows(), Eigen::NoChange);
  return sim::World({input}, ground(), {{0, -9.81, 0}, kStep});
}

}  // namespace

int main() {
  keep_freed_memory();
  set_thread_count(1);
  {
    std::vector<double> ratios;
    for (int i = 0; i < kRepetitions; ++i) {
      sim::World few = hopper(16), many = hopper(160);
      const double with_few = step_seconds(few, 200), with_many = step_seconds(many, 200);
      ratios.push_back(with_many / with_few);
    }
    std::printf("hopper with 160 contact points over one with 16: %.2f\n", median(ratios));
  }

  const auto pile_seconds = [](int threads, int settle, int steps) {
    set_thread_count(threads);
    sim::World world = pile_world({.spheres = 50}, kStep);
    step_seconds(world, settle);
    return step_seconds(world, steps);
  };
  const auto apart_seconds = [](int threads, int count, int settle, int steps) {
    set_thread_count(threads);
    sim::World world = apart_world(count, kStep);
    step_seconds(world, settle);
    return step_seconds(world, steps);
  };
  std::printf("%-12s %12s %12s %18s %22s\n", "50 spheres", "pile ms", "apart ms", "pile / apart",
              "2 threads: pile, apart");
  for (const auto& [name, settle] :
       {std::pair("falling", 20), std::pair("landing", 60), std::pair("at rest", 200)}) {
    std::vector<double> pile, apart, cost, pile_gain, apart_gain;
    for (int i = 0; i < 3; ++i) {
      const double p1 = pile_seconds(1, settle, 20), a1 = apart_seconds(1, 50, settle, 20);
      const double p2 = pile_seconds(2, settle, 20), a2 = apart_seconds(2, 50, settle, 20);
      pile.push_back(1e3 * p1);
      apart.push_back(1e3 * a1);
      cost.push_back(p1 / a1);
      pile_gain.push_back(p1 / p2);
      apart_gain.push_back(a1 / a2);
    }
    std::printf("%-12s %12.2f %12.2f %18.2f %14.2f %7.2f\n", name, median(pile), median(apart), median(cost),
                median(pile_gain), median(apart_gain));
  }
  return 0;
}
