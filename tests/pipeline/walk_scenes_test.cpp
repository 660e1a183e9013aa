// Scenes of configs/ in which flat characters walk, as they are shipped: steps counted from the saved
// positions, and the laws of physics.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/file.h"
#include "common/hdf5_file.h"
#include "tests/common/temporary_folder.h"
#include "tests/pipeline/program.h"
#include "tests/pipeline/simulated_run.h"

namespace vivify::pipeline {
namespace {

using testing_support::Steps;

// A foot of a body of the plane: the vertices in the left or right half of the lowest tenth at rest.
struct Foot {
  std::vector<int> vertices;
  double place(const RowMatrixXd& x) const { return x(vertices, 0).mean(); }
  double sole(const RowMatrixXd& x) const { return x(vertices, 1).minCoeff(); }
};

Foot foot_of(const RowMatrixXd& rest, bool left) {
  const Eigen::RowVectorXd low = rest.colwise().minCoeff(), high = rest.colwise().maxCoeff();
  Foot foot;
  for (int v = 0; v < rest.rows(); ++v) {
    const Eigen::RowVectorXd share = (rest.row(v) - low).array() / (high - low).array();
    if (share[1] <= 0.1 && (share[0] < 0.5) == left) foot.vertices.push_back(v);
  }
  return foot;
}

// Times that the foot was raised by 1 % of the height and put down at least 5 % further towards `side` (±1).
int count_steps(const std::vector<RowMatrixXd>& frames, const Foot& foot, double height, int side) {
  int steps = 0;
  bool raised = false;
  double from = foot.place(frames.front());
  for (const RowMatrixXd& x : frames) {
    if (foot.sole(x) > 0.01 * height) raised = true;
    if (foot.sole(x) > 0.004 * height) continue;
    if (raised) {
      steps += side * (foot.place(x) - from) > 0.05 * height;
      raised = false;
    }
    from = foot.place(x);
  }
  return steps;
}

struct WalkScene {
  const char* name;
  double dofs, parameters;     // of Table 1
  std::vector<double> places;  // x to walk to, m; the first is that of the scene
};

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
    const auto& body = summary["bodies"]["castle"];
    EXPECT_NEAR(body["dofs"], GetParam().dofs, 0.1 * GetParam().dofs);

    std::vector<RowMatrixXd> frames;
    for (int frame = 1; frame <= summary["frames"]; ++frame) {
      const std::string number = std::to_string(10000 + frame).substr(1);
      const Hdf5Reader file(out / ("sim/frames/" + number + ".h5"));
      EXPECT_NEAR(static_cast<double>(file.vector("/bodies/castle/p").size()), GetParam().parameters,
                  0.1 * GetParam().parameters);
      frames.push_back(file.matrix("/bodies/castle/x"));
    }
    const Foot left = foot_of(frames.front(), true), right = foot_of(frames.front(), false);
    const int steps = count_steps(frames, left, kHeight, side) + count_steps(frames, right, kHeight, side);
    EXPECT_GE(steps, 8);
    const double middle = (left.place(frames.back()) + right.place(frames.back())) / 2;
    EXPECT_NEAR(middle, place, 0.15);

    const Steps rows(out / "sim/steps.csv");
    EXPECT_LE(rows.largest("tilt_deg"), 45);
    EXPECT_LE(rows.largest("residual_rel"), 1e-8);
    EXPECT_LE(rows.largest("max_penetration_m"), 0.01 * kHeight);
    EXPECT_LE(rows.largest("p_rate"), 12 * kHeight);
    const double weight = 9.81 * Hdf5Reader(out / "mesh/castle.h5").vector("/mass").sum();
    EXPECT_LE(rows.largest("internal_force_sum_n"), 1e-9 * weight);
    EXPECT_LE(rows.largest("internal_torque_sum_nm"), 1e-9 * weight * kHeight);
  }
}

INSTANTIATE_TEST_SUITE_P(Castle, WalkScenes,
                         ::testing::Values(WalkScene{"castle_solid.yaml", 142, 22, {1.4, -0.9}},
                                           WalkScene{"castle_rod.yaml", 64, 22, {0.9}}),
                         [](const auto& tested) { return tested.index == 0 ? "Solid" : "Rod"; });

}  // namespace
}  // namespace vivify::pipeline
