// Problems of the sizes of Table 1 of Coros et al. 2012: degrees of freedom (within a tenth), control
// parameters, rest space and elastic model, with goals for the centre of mass and contact with the ground.
// Prints the time that one simulated second takes on one core beside the printed one (one core of a 3.2 GHz
// Core i7-960, 2012).
//   table1_bench [NAME]      only the rows whose name contains NAME
#include <cstdio>
#include <string>
#include <vector>

#include "bench/bodies.h"
#include "bench/timing.h"
#include "common/memory.h"
#include "sim/world.h"

using namespace vivify;
using namespace vivify::bench;

namespace {

// The paper steps by 1/100 to 1/30 s and does not say which scene by which.
constexpr int kStepsPerSecond[] = {30, 100};
constexpr double kSeconds = 2;

struct Row {
  std::string name;
  int dofs, parameters;
  std::string space, model;
  double printed;  // s per simulated second
  SimMesh mesh;
};

// Flat characters, as pictures of cells.
SimMesh castle() {
  return letter({"#.#.#.#",  //
                 "#######",  //
                 "#######",  //
                 ".#####.",  //
                 ".##.##.",  //
                 ".##.##.",  //
                 ".##.##.",  //
                 ".##.##.",  //
                 "###.###"},
                1, 1.0 / 9);
}
SimMesh letter_a() {
  return letter({".####.",  //
                 "##..##",  //
                 "######",  //
                 "##..##"},
                1, 1.0 / 4);
}
SimMesh letter_h() {
  return letter({"##..##",  //
                 "##..##",  //
                 "##..##",  //
                 "######",  //
                 "##..##",  //
                 "##..##",  //
                 "##..##"},
                1, 1.0 / 7);
}
SimMesh letter_i() {
  return letter({"####",  //
                 ".##.",  //
                 ".##.",  //
                 ".##.",  //
                 "####"},
                1, 0.2);
}
SimMesh letter_p() {
  return letter({"####",  //
                 "#..#",  //
                 "####",  //
                 "##..",  //
                 "##..",  //
                 "##.."},
                1, 1.0 / 6);
}
SimMesh letter_s() {
  return letter({"#####",  //
                 "##...",  //
                 "#####",  //
                 "#####",  //
                 "...##",  //
                 "#####",  //
                 "#####"},
                1, 1.0 / 7);
}
SimMesh letter_g() {
  return letter({".#####.",  //
                 "#######",  //
                 "##.....",  //
                 "##..###",  //
                 "##..###",  //
                 "##...##",  //
                 "#######",  //
                 ".#####."},
                1, 1.0 / 8);
}
SimMesh pirate() {
  return letter({"..####..",  //
                 "..####..",  //
                 "########",  //
                 "########",  //
                 "..####..",  //
                 "..####..",  //
                 ".######.",  //
                 ".######.",  //
                 ".##..##.",  //
                 ".##..##.",  //
                 ".##..##.",  //
                 "###..###"},
                1, 1.0 / 12);
}

std::vector<Row> table() {
  return {
      {"Sphere", 246, 24, "cage", "solid3d", 2.6, ball(0.4, 2, 1)},
      {"Ace 1", 231, 3, "examples", "shell3d", 9.2, card(6, 10, 0.1)},
      {"Ace 2", 231, 42, "cage", "shell3d", 14.1, card(6, 10, 0.1)},
      {"Castle 1", 142, 22, "cage", "solid2d", 1.1, castle()},
      {"Castle 2", 64, 22, "cage", "rod2d", 0.57, closed_rod(32, 0.8, 1)},
      {"Tea Cups, small", 228, 24, "cage", "solid3d", 5.64, box(4, 4, 2, 0.25)},
      {"Tea Cups, large", 375, 24, "cage", "solid3d", 16.5, box(4, 4, 4, 0.25)},
      {"S and G, small", 100, 8, "cage", "solid2d", 0.8, letter_s()},
      {"S and G, large", 130, 36, "cage", "solid2d", 2.1, letter_g()},
      {"I and P, small", 54, 3, "examples", "solid2d", 0.8, letter_i()},
      {"I and P, large", 64, 3, "examples", "solid2d", 0.9, letter_p()},
      {"A, R, H, small", 66, 20, "cage", "solid2d", 0.8, letter_a()},
      {"A, R, H, large", 104, 28, "cage", "solid2d", 1.9, letter_h()},
      {"3D Cross", 1128, 6, "examples", "solid3d", 21.7, cross(2, {7, 6, 7, 6, 7, 6}, 0.07)},
      {"Pirate", 188, 12, "examples", "solid2d", 3.16, pirate()},
      {"Cheesy", 243, 150, "cage", "solid3d", 8.6, box(2, 8, 2, 0.125)},
      {"Crusty 1", 114, 12, "examples", "solid3d", 7.8, box(2, 3, 2, 0.3)},
      {"Crusty 2", 114, 57, "cage", "solid3d", 9.8, box(2, 3, 2, 0.3)},
  };
}

sim::BodyInput body_of(const Row& row) {
  const std::string controller = row.name == "Sphere"
                                     ? "{type: roll, heading_deg: 90}"
                                     : "{type: hop, heading_deg: 90, height: 0.2, pace: 0.5, upright: 0}";
  const double height = row.mesh.V.col(1).maxCoeff();
  const std::string model = row.model == "rod2d"
                                ? "{type: rod2d, density: 10, stiffness: 10000, bending_stiffness: 60}"
                            : row.model == "shell3d" ? "{type: shell3d}"
                                                     : lively_model(row.model, row.mesh);
  sim::BodyInput input = body_input(row.name, row.mesh, model, controller);
  input.rest_space = row.space;
  if (row.space == "examples") {
    input.examples = waves(row.mesh.V, row.parameters);
  } else if (row.parameters != row.mesh.dimension() << row.mesh.dimension()) {
    input.cage_weights = spread_weights(row.mesh.V, row.parameters / row.mesh.dimension());
  }
  if (!(height > 0)) throw Error(ErrorKind::internal, "the body is flat");
  return input;
}

struct Result {
  double per_second, iterations, halvings, guards, height, travel;
  int fallbacks, substeps;
};

Result simulate(const sim::BodyInput& input, int rate) {
  sim::WorldSettings settings;
  settings.h = 1.0 / rate;
  sim::World world({input}, ground(), settings);
  const int steps = static_cast<int>(kSeconds * rate);
  Result result{};
  double low = INFINITY, high = -INFINITY;
  for (int step = 0; step < steps; ++step) {
    result.per_second += seconds_of([&] { world.step(); }) / kSeconds;
    const sim::StepRecord& record = world.records().back();
    result.iterations += static_cast<double>(record.iterations) / steps;
    result.halvings += static_cast<double>(record.halvings) / steps;
    result.fallbacks += record.fallback > 0;
    result.substeps = std::max(result.substeps, record.substeps);
    low = std::min(low, record.com.y());
    high = std::max(high, record.com.y());
    result.travel = record.com.x();
  }
  result.height = high - low;
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  vivify::keep_freed_memory();
  std::printf("%-16s %5s %4s %-9s %-8s %9s", "row", "DOF", "par", "space", "model", "paper s/s");
  for (const int rate : kStepsPerSecond)
    std::printf(" | h = 1/%-3d s/s  ratio   it  other  rise  path", rate);
  std::printf("\n");
  try {
    for (const Row& row : table()) {
      if (argc > 1 && row.name.find(argv[1]) == std::string::npos) continue;
      const sim::BodyInput input = body_of(row);
      const int dofs = static_cast<int>(row.mesh.V.size());
      std::printf("%-16s %5d %4d %-9s %-8s %9.2f", row.name.c_str(), dofs, row.parameters, row.space.c_str(),
                  row.model.c_str(), row.printed);
      std::fflush(stdout);
      if (std::abs(dofs - row.dofs) > 0.1 * row.dofs) {
        throw Error(ErrorKind::internal, "a row of Table 1 has " + std::to_string(row.dofs) + " DOFs");
      }
      for (const int rate : kStepsPerSecond) {
        const Result result = simulate(input, rate);
        std::printf(" | %13.4f %6.3f %4.1f %5d %5.2f %5.2f", result.per_second,
                    result.per_second / row.printed, result.iterations, result.fallbacks, result.height,
                    result.travel);
        std::fflush(stdout);
      }
      std::printf("\n");
    }
    return 0;
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.full_text().c_str());
    return exit_code(error.kind());
  }
}
