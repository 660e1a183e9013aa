// Scenes of configs/ in which flat characters walk, as they are shipped: steps counted from the saved
// positions, and the laws of physics.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/file.h"
#include "common/hdf5_file.h"
#include "tests/common/temporary_folder.h"
#include "tests/pipeline/program.h"
#include "tests/pipeline/simulated_run.h"
#include "tests/pipeline/walk_steps.h"

namespace vivify::pipeline {
namespace {

using testing_support::count_steps;
using testing_support::Foot;
using testing_support::foot_of;
using testing_support::Steps;

struct WalkScene {
  const char* name;
  const char* body;
  int steps;
  double dofs, parameters;     // of Table 1
  std::vector<double> places;  // x to walk to, m; the first is that of the scene
};
void PrintTo(const WalkScene& scene, std::ostream* out) { *out << scene.name; }

class WalkScenes : public ::testing::TestWithParam<WalkScene> {};

TEST_P(WalkScenes, TakesStepsAndStandsAtItsPlace) {
  constexpr double kHeight = 1;
  for (const double place : GetParam().places) {
    const int side = place > 0 ? 1 : -1;
    SCOPED_TRACE(side > 0 ? "to the right" : "to the left");
    const testing_support::TemporaryFolder folder;
    const std::filesystem::path out = folder / "out";
    std::vector<std::string> command = {"simulate",
                                        VIVIFY_SOURCE_DIR "/configs/" + std::string(GetParam().name),
                                        "-o",
                                        out.string(),
                                        "--progress=none",
                                        "-q"};
    if (place != GetParam().places.front()) {
      command.insert(command.end(),
                     {"--set", "bodies[0].controller.to=[" + std::to_string(place) + ", 0, 0]"});
    }
    const testing_support::Outcome outcome = testing_support::vivify(command);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const auto summary = nlohmann::json::parse(read_text_file(out / "sim/summary.json"));
    const auto& body = summary["bodies"][GetParam().body];
    EXPECT_NEAR(body["dofs"], GetParam().dofs, 0.1 * GetParam().dofs);

    const std::string group = std::string("/bodies/") + GetParam().body;
    std::vector<RowMatrixXd> frames;
    for (int frame = 1; frame <= summary["frames"]; ++frame) {
      const std::string number = std::to_string(10000 + frame).substr(1);
      const Hdf5Reader file(out / ("sim/frames/" + number + ".h5"));
      EXPECT_NEAR(static_cast<double>(file.vector(group + "/p").size()), GetParam().parameters,
                  0.1 * GetParam().parameters);
      frames.push_back(file.matrix(group + "/x"));
    }
    const Foot left = foot_of(frames.front(), true), right = foot_of(frames.front(), false);
    EXPECT_GE(count_steps(frames, kHeight, side), GetParam().steps);
    const auto middle = [&](const RowMatrixXd& x) { return (left.place(x) + right.place(x)) / 2; };
    EXPECT_NEAR(middle(frames.back()) - middle(frames.front()), place, 0.15);

    const Steps rows(out / "sim/steps.csv");
    EXPECT_LE(rows.largest("tilt_deg"), 45);
    EXPECT_LE(rows.largest("residual_rel"), 1e-8);
    EXPECT_LE(rows.largest("max_penetration_m"), 0.01 * kHeight);
    EXPECT_LE(rows.largest("p_rate"), 12 * kHeight);
    EXPECT_LT(rows.largest("rest_rate_per_s"), 12);
    const double weight =
        9.81 * Hdf5Reader(out / "mesh" / (std::string(GetParam().body) + ".h5")).vector("/mass").sum();
    EXPECT_LE(rows.largest("internal_force_sum_n"), 1e-9 * weight);
    EXPECT_LE(rows.largest("internal_torque_sum_nm"), 1e-9 * weight * kHeight);
  }
}

constexpr const char* kLabels[] = {"CastleSolid", "CastleRod", "Pirate"};
INSTANTIATE_TEST_SUITE_P(Flat, WalkScenes,
                         ::testing::Values(WalkScene{"castle_solid.yaml", "castle", 8, 142, 22, {1.4, -0.9}},
                                           WalkScene{"castle_rod.yaml", "castle", 8, 64, 22, {0.9}},
                                           WalkScene{"pirate.yaml", "pirate", 10, 188, 12, {1.2, -1.3}}),
                         [](const auto& tested) { return std::string(kLabels[tested.index]); });

}  // namespace
}  // namespace vivify::pipeline
