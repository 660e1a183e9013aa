// The characters of Table 1 of Coros et al. 2012 as their scenes in configs/ make them, on one core: degrees
// of freedom, parameters, step size, iterations per step and seconds per simulated second, beside the printed
// ones (one core of a 3.2 GHz Core i7-960, 2012).
//   cast FOLDER [NAME]      simulates into FOLDER; only the scenes whose name contains NAME
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/error.h"
#include "common/file.h"
#include "common/hdf5_file.h"
#include "pipeline/child_process.h"
#include "tests/pipeline/simulated_run.h"

using namespace vivify;

namespace {

struct Row {
  const char* scene;
  const char* body;
  const char* printed_sizes;  // #x / #p
  double printed;             // s per simulated second; the lower end of a range
};

constexpr Row kRows[] = {
    {"sphere", "sphere", "246/24", 2.6},     {"tea_cups", "cup", "228-375/24", 5.64},
    {"tea_cups", "mug", "228-375/24", 5.64}, {"tea_cups", "espresso", "228-375/24", 5.64},
    {"castle_solid", "castle", "142/22", 1.1},
    {"castle_rod", "castle", "64/22", 0.57}, {"pirate", "pirate", "188/12", 3.16},
    {"crusty_race", "light", "114/12", 7.8}, {"crusty_race", "dark", "114/57", 9.8},
    {"cheesy", "cheesy", "243/150", 8.6},    {"ace_cage", "ace", "231/42", 14.1},
    {"ace_examples", "ace", "231/3", 9.2},   {"cross", "cross", "1128/6", 21.7},
    {"letters", "S", "100-130/8-36", 0.8},   {"letters", "I", "54-64/3", 0.8},
    {"letters", "G", "100-130/8-36", 0.8},   {"letters", "G2", "100-130/8-36", 0.8},
    {"letters", "R", "66-104/20-28", 0.8},   {"letters", "A", "66-104/20-28", 0.8},
    {"letters", "P", "54-64/3", 0.8},        {"letters", "H", "66-104/20-28", 0.8},
};

void simulate(const std::string& scene, const std::filesystem::path& out) {
  pipeline::ChildProcess vivify(
      VIVIFY_PROGRAM, {"simulate", VIVIFY_SOURCE_DIR "/configs/" + scene + ".yaml", "-o", out.string(),
                       "--threads", "1", "--force=simulate", "-q"});
  const pipeline::ChildProcess::Outcome outcome = vivify.finish();
  if (!outcome.success) throw Error(ErrorKind::io, scene + " " + outcome.ending, outcome.output);
}

void print(const Row& row, const std::filesystem::path& out) {
  const testing_support::Steps steps(out / "sim/steps.csv");
  double iterations = 0;
  int count = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps.text("body", i) != row.body) continue;
    iterations += steps("sqp_iterations", i);
    ++count;
  }
  const Hdf5Reader frame(out / "sim/frames/0001.h5");
  const std::string group = std::string("/bodies/") + row.body;
  const nlohmann::json timing =
      nlohmann::json::parse(read_text_file(out / "timing.json"))["bodies"][row.body];
  const double seconds = timing["wall_per_sim_second"];
  std::printf("%-12s %-10s %5ld/%-4ld %-11s %6.4f %6.1f %9.3f %8.2f %7.1f %%\n", row.scene, row.body,
              static_cast<long>(frame.matrix(group + "/x").size()),
              static_cast<long>(frame.vector(group + "/p").size()), row.printed_sizes,
              timing["sim_seconds"].get<double>() / count, iterations / count, seconds, row.printed,
              100 * seconds / row.printed);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') {
    std::fprintf(stderr, "cast FOLDER [NAME]\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  const std::string only = argc > 2 ? argv[2] : "";
  std::printf("%-12s %-10s %10s %-11s %6s %6s %9s %8s %9s\n", "scene", "body", "#x/#p", "printed", "h, s",
              "it.", "s/s", "printed", "ratio");
  try {
    std::string simulated;
    for (const Row& row : kRows) {
      if (std::string(row.scene).find(only) == std::string::npos) continue;
      const std::filesystem::path out = folder / row.scene;
      if (simulated != row.scene) simulate(row.scene, out);
      simulated = row.scene;
      print(row, out);
    }
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.full_text().c_str());
    return 1;
  }
}
