// Cost and memory against the degrees of freedom, from 100 to 100 000: a step of a body that is controlled
// through a cage (24 parameters in space, 8 in the plane) and a passive one, each in a process of its own for
// its peak memory. Times are processor time on one thread.
//   scaling_bench [LARGEST]      at most so many degrees of freedom
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "bench/bodies.h"
#include "bench/timing.h"
#include "common/parallel.h"
#include "sim/world.h"

using namespace vivify;
using namespace vivify::bench;

namespace {

constexpr int kSteps = 4;  // of every body, from the start
constexpr double kEnough =
    1;  // s; small bodies start over until they took that long, and their median counts
constexpr int kMostRuns = 31;

struct Cost {
  double set_up = 0, step = 0, iterations = 0;  // s, s
  double memory = 0;                            // peak, bytes
};

// Steps of the thrust of a hop, or of the same time without control.
Cost measure(const SimMesh& mesh, const std::string& model, bool controlled) {
  Cost cost;
  set_thread_count(1);
  const std::string controller =
      controlled ? "{type: hop, heading_deg: 90, height: 0.2, pace: 0.5, crouch_s: 0.01, thrust_s: 1}" : "{}";
  std::vector<double> times;
  for (double spent = 0; times.empty() || (spent < kEnough && times.size() < kMostRuns);
       spent += times.back()) {
    std::unique_ptr<sim::World> world;
    cost.set_up = seconds_of([&] {
      world = std::make_unique<sim::World>(std::vector{body_input("body", mesh, model, controller)}, ground(),
                                           sim::WorldSettings{});
    });
    times.push_back(seconds_of([&] {
      for (int step = 0; step < kSteps; ++step) world->step();
    }));
    cost.iterations = 0;
    for (const sim::StepRecord& record : world->records()) cost.iterations += record.iterations;
  }
  cost.step = median(times) / kSteps;
  cost.iterations /= kSteps;
  return cost;
}

// In a process of its own.
Cost measure_apart(const SimMesh& mesh, const std::string& model, bool controlled) {
  int ends[2];
  if (pipe(ends) != 0) throw Error(ErrorKind::io, "no pipe could be made");
  std::fflush(stdout);
  const pid_t child = fork();
  if (child < 0) throw Error(ErrorKind::io, "no process could be started");
  if (child == 0) {
    int status = 1;
    try {
      const Cost cost = measure(mesh, model, controlled);
      status = write(ends[1], &cost, sizeof cost) == sizeof cost ? 0 : 1;
    } catch (const Error& error) {
      std::fprintf(stderr, "%s\n", error.full_text().c_str());
    }
    _exit(status);
  }
  close(ends[1]);
  Cost cost;
  const bool complete = read(ends[0], &cost, sizeof cost) == sizeof cost;
  close(ends[0]);
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  if (!complete || status != 0) throw Error(ErrorKind::numerical, "a body could not be stepped");
  cost.memory = 1024.0 * static_cast<double>(usage.ru_maxrss);
  return cost;
}

// Slope of log y over log x by least squares.
double exponent(const std::vector<double>& x, const std::vector<double>& y) {
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const double n = static_cast<double>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double a = std::log(x[i]), b = std::log(y[i]);
    sx += a;
    sy += b;
    sxx += a * a;
    sxy += a * b;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

void run(const std::string& title, const std::string& model, const std::vector<SimMesh>& meshes,
         double largest) {
  std::printf("%s\n%9s %10s | %12s %10s | %12s %6s %10s\n", title.c_str(), "DOF", "set up s", "passive ms",
              "MB", "controlled", "it", "MB");
  std::vector<double> dofs, passive_time, passive_memory, time, memory;
  for (const SimMesh& mesh : meshes) {
    if (static_cast<double>(mesh.V.size()) > largest) break;
    const std::string lively = lively_model(model, mesh);
    const Cost passive = measure_apart(mesh, lively, false), controlled = measure_apart(mesh, lively, true);
    dofs.push_back(static_cast<double>(mesh.V.size()));
    passive_time.push_back(passive.step);
    passive_memory.push_back(passive.memory);
    time.push_back(controlled.step);
    memory.push_back(controlled.memory);
    std::printf("%9.0f %10.3f | %12.3f %10.1f | %12.3f %6.1f %10.1f\n", dofs.back(), controlled.set_up,
                1e3 * passive.step, 1e-6 * passive.memory, 1e3 * controlled.step, controlled.iterations,
                1e-6 * controlled.memory);
    std::fflush(stdout);
  }
  std::printf("%9s %10s | %12.2f %10.2f | %12.2f %6s %10.2f\n", "exponent", "", exponent(dofs, passive_time),
              exponent(dofs, passive_memory), exponent(dofs, time), "", exponent(dofs, memory));
  const std::size_t half = dofs.size() / 2;
  const auto upper = [&](const std::vector<double>& y) {
    return exponent({dofs.begin() + static_cast<long>(half), dofs.end()},
                    {y.begin() + static_cast<long>(half), y.end()});
  };
  std::printf("%9s %10s | %12.2f %10.2f | %12.2f %6s %10.2f\n\n", "of the", "upper half", upper(passive_time),
              upper(passive_memory), upper(time), "", upper(memory));
}

}  // namespace

int main(int argc, char** argv) {
  const double largest = argc > 1 ? std::atof(argv[1]) : 1e9;
  try {
    std::vector<SimMesh> boxes, rectangles;
    for (const int n : {2, 3, 5, 7, 11, 17, 27}) {  // 2 n cells high, n by ¾ n wide
      boxes.push_back(box(n, 2 * n, std::max(1, 3 * n / 4), 0.5 / n));
    }
    for (const int n : {5, 9, 16, 28, 50, 89, 158}) {
      rectangles.push_back(rectangle(n, 2 * n, 0.5 / n));
    }
    run("solids of space: boxes, 24 parameters", "solid3d", boxes, largest);
    run("solids of the plane: rectangles, 8 parameters", "solid2d", rectangles, largest);
    return 0;
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.full_text().c_str());
    return exit_code(error.kind());
  }
}
