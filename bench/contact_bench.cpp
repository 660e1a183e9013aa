// What contact costs, as ratios from one run: contact points of a hopper, a sphere of a pile beside one alone
// in the same bowl, and two threads beside one for the pile and for spheres that do not touch.
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
constexpr int kRepetitions = 5, kSpheres = 50;

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

  // The same motions (to the bit) with one thread and with two, step by step in turn.
  struct Run {
    sim::World world;
    int threads;
    double seconds = 0;
  };
  Run runs[] = {{pile_world({.spheres = kSpheres}, kStep), 1},
                {pile_world({.spheres = kSpheres}, kStep), 2},
                {apart_world(kSpheres, kStep), 1},
                {apart_world(kSpheres, kStep), 2},
                {pile_world({.spheres = 1}, kStep), 1}};
  std::printf("%d spheres: one of the pile over one alone (one thread), two threads over one: pile, apart\n",
              kSpheres);
  for (const auto& [name, end] :
       {std::pair("falling", 25), std::pair("landing", 90), std::pair("coming to rest", 180)}) {
    for (Run& run : runs) run.seconds = 0;
    for (long step = runs[0].world.steps(); step < end; ++step) {
      for (Run& run : runs) {
        set_thread_count(run.threads);
        run.seconds += step_seconds(run.world, 1);
      }
    }
    std::printf("  until step %3d, %-15s %6.2f %8.2f %6.2f\n", end, name,
                runs[0].seconds / kSpheres / runs[4].seconds, runs[0].seconds / runs[1].seconds,
                runs[2].seconds / runs[3].seconds);
    std::fflush(stdout);
  }
  return 0;
}
