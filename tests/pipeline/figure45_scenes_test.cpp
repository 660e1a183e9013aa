// The shipped scenes of Figures 4 and 5: the incompatible interpolation of poses beside interpolation in
// strain space.
#include <gtest/gtest.h>

#include "bench/figures/blends.h"
#include "tests/common/temporary_folder.h"
#include "tests/pipeline/program.h"

namespace vivify::pipeline {
namespace {

using figures::Blend;
using figures::BlendFrame;
using testing_support::Outcome;

// The bodies `ours` and `reference` of a shipped scene, simulated with changes of its settings.
Blend simulate(const std::string& scene, const std::vector<std::string>& changes = {}) {
  const testing_support::TemporaryFolder out;
  std::vector<std::string> arguments = {"simulate", std::string(VIVIFY_SOURCE_DIR) + "/configs/" + scene,
                                        "-o", out.path().string(), "--progress=none"};
  for (const std::string& change : changes) arguments.insert(arguments.end(), {"--set", change});
  const Outcome outcome = testing_support::vivify(arguments);
  if (outcome.code != 0) throw std::runtime_error(outcome.err);
  return figures::compare_blends(out.path(), "ours", "reference");
}

// Acceptance: 1 % of the length of the bar at every weight.
TEST(Figure4, TwistedBarIsThatOfGreenStrainProjection) {
  const Blend blend = simulate("figure4.yaml");
  ASSERT_EQ(blend.frames.size(), 100u);
  EXPECT_EQ(blend.frames.front().weight, 0);
  EXPECT_NEAR(blend.frames.back().weight, 1, 1e-12);
  for (const BlendFrame& frame : blend.frames) EXPECT_LE(frame.distance, 0.01) << "weight " << frame.weight;
  EXPECT_GT(worst(blend, &BlendFrame::distance).distance, 1e-4) << "the methods are not the same";
  EXPECT_LE(blend.end_distance, 1e-6);
}

// Acceptance: edges within 1 %, the shape within 5 % of the length of the tube. At every fifth weight.
TEST(Figure5, HelixIsThatOfLengthsAndAngles) {
  const Blend blend = simulate("figure5.yaml", {"frames.fps=5"});
  ASSERT_EQ(blend.frames.size(), 20u);
  EXPECT_GE(blend.frames.back().weight, 0.95);
  for (const BlendFrame& frame : blend.frames) {
    EXPECT_LE(frame.distance, 0.05) << "weight " << frame.weight;
    EXPECT_LE(frame.first_edges, 0.01) << "weight " << frame.weight;
  }
  EXPECT_GT(worst(blend, &BlendFrame::distance).distance, 1e-4) << "the methods are not the same";
}

}  // namespace
}  // namespace vivify::pipeline
