// configs/figure3_*.yaml as they are shipped: the letter I hops left with each of the four rest spaces, by
// the laws of physics, in four different ways.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/file.h"
#include "tests/pipeline/cast.h"

namespace vivify::pipeline {
namespace {

using testing_support::Flight;
using testing_support::SceneResult;
using testing_support::Steps;

constexpr double kHeight = 1;
constexpr int kFrames = 144;

// Positions of the vertices about their mean in every frame.
std::vector<RowMatrixXd> poses(const SceneResult& run) {
  std::vector<RowMatrixXd> poses = run.motion("letter");
  for (RowMatrixXd& x : poses) x.rowwise() -= x.colwise().mean().eval();
  return poses;
}

TEST(Figure3, TheLetterHopsLeftInFourStyles) {
  const testing_support::TemporaryFolder folder;
  const std::vector<std::string> styles = {"full", "cage", "bent", "compressed"};
  std::vector<std::vector<RowMatrixXd>> motions;
  for (const std::string& style : styles) {
    SCOPED_TRACE(style);
    const std::filesystem::path out = folder / style;
    const SceneResult run = testing_support::simulated(out, "figure3_" + style + ".yaml");
    testing_support::expect_played(run, "figure3_" + style);
    const auto summary = nlohmann::json::parse(read_text_file(out / "sim/summary.json"));
    const int dofs = summary["bodies"]["letter"]["dofs"];
    EXPECT_GE(dofs, 54);
    EXPECT_LE(dofs, 130);

    const Steps& steps = run.steps();
    const double h = summary["h_s"];
    std::size_t left = 0;
    for (const Flight& flight : testing_support::flights(steps, h)) {
      if (flight.clearance < 0.05 * kHeight) continue;
      EXPECT_GE(flight.duration, 0.12);
      left += steps("com_x_m", flight.last) < steps("com_x_m", flight.first) - 0.02 * kHeight;
      for (std::size_t i = flight.first; i <= flight.last; ++i) {
        const double n = static_cast<double>(i - flight.first);
        const double fall =
            steps("com_y_m", i) - steps("com_y_m", flight.first) - n * h * steps("vel_y_m_s", flight.first);
        EXPECT_NEAR(fall, -9.81 * h * h * n * (n + 1) / 2, 1e-8);
      }
    }
    EXPECT_GE(left, 2u);
    motions.push_back(poses(run));
    ASSERT_EQ(motions.back().size(), kFrames);
  }
  for (std::size_t a = 0; a < motions.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      double sum = 0;
      for (int frame = 0; frame < kFrames; ++frame) {
        sum += (motions[a][static_cast<std::size_t>(frame)] - motions[b][static_cast<std::size_t>(frame)])
                   .rowwise()
                   .squaredNorm()
                   .mean();
      }
      EXPECT_GE(std::sqrt(sum / kFrames), 0.05 * kHeight) << styles[a] << " against " << styles[b];
    }
  }
}

}  // namespace
}  // namespace vivify::pipeline
