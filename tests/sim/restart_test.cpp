// A world that goes on from any of its frames passes through the same bits.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <set>
#include <vector>

#include "tests/sim/conformance.h"

namespace vivify::sim {
namespace {

constexpr int kFrames = 10, kStepsPerFrame = 3;

class Restart : public ::testing::TestWithParam<BodyCase> {
 protected:
  void SetUp() override { std::filesystem::create_directory(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path frame(int k) const { return folder_ / (std::to_string(k) + ".h5"); }

 private:
  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("vivify_restart_test_" + std::to_string(getpid()));
};

std::vector<BodyCase> restart_cases() {
  std::vector<BodyCase> cases;
  for (const BodyCase& body : body_cases(elastic_models(), rest_spaces())) {
    if (body.mesh.name != "ring" && body.mesh.name != "arch") cases.push_back(body);
  }
  return cases;
}
INSTANTIATE_TEST_SUITE_P(Every, Restart, ::testing::ValuesIn(restart_cases()), case_name);

TEST_P(Restart, AtAnyFrameGivesTheSameBits) {
  const BodyInput input = body_input(
      GetParam(), {.model = "damping_s: 0.002",
                   .controller = "{type: hop, heading_deg: 90, height: 0.1, crouch_s: 0.05, thrust_s: 0.1, "
                                 "land_s: 0.05}"});
  const auto make = [&] { return World({input}, one(plane(0.7)), {.h = 1.0 / 72}); };
  World whole = make();
  std::vector<std::string> lines;
  Hdf5Writer initial;
  whole.save(initial);
  initial.save(frame(0));
  std::set<std::string> phases;
  for (int k = 1; k <= kFrames; ++k) {
    for (int step = 0; step < kStepsPerFrame; ++step) whole.step();
    for (const StepRecord& record : whole.records()) {
      lines.push_back(csv_line(record));
      phases.insert(record.phase);
    }
    Hdf5Writer saved;
    whole.save(saved);
    saved.save(frame(k));
  }
  EXPECT_GE(phases.size(), 2u);
  EXPECT_GT(whole.body(0).p().norm(), 0);

  for (int k = 0; k < kFrames; ++k) {
    World resumed = make();
    resumed.restore(Hdf5Reader(frame(k)));
    ASSERT_EQ(resumed.steps(), k * kStepsPerFrame);
    while (resumed.steps() < kFrames * kStepsPerFrame) {
      resumed.step();
      ASSERT_EQ(csv_line(resumed.records().back()), lines[static_cast<std::size_t>(resumed.steps()) - 1])
          << "from frame " << k;
    }
    EXPECT_EQ(resumed.body(0).x(), whole.body(0).x()) << "from frame " << k;
    EXPECT_EQ(resumed.body(0).v(), whole.body(0).v()) << "from frame " << k;
    EXPECT_EQ(resumed.body(0).p(), whole.body(0).p()) << "from frame " << k;
  }
}

}  // namespace
}  // namespace vivify::sim
