// Pushes of bodies from the scene file to the simulation, and what is wrong with them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "common/hdf5_file.h"
#include "tests/pipeline/program.h"
#include "tests/pipeline/simulated_run.h"
#include "tests/pipeline/tiny_scene.h"

namespace vivify::pipeline {
namespace {

using testing::HasSubstr;
using testing_support::Outcome;
using testing_support::Steps;
using testing_support::TinyScene;
using testing_support::vivify;

Outcome run(const std::string& command, const TinyScene& scene, std::vector<std::string> options = {}) {
  std::vector<std::string> arguments = {command, scene.file().string()};
  if (command != "check") arguments.insert(arguments.end(), {"-o", scene.out().string(), "--progress=none"});
  arguments.insert(arguments.end(), options.begin(), options.end());
  return vivify(arguments);
}

// In the air, so that nothing but its weight and the push acts on the ball.
TEST(Pushes, OfTheCommandLineChangeTheMomentum) {
  TinyScene scene;
  scene.change("position: [0, 0.5, 0]", "position: [0, 3, 0]");
  const Outcome outcome = run(
      "simulate", scene, {"--set", "bodies.ball.pushes=[{at_s: 0.05, for_s: 0.11, impulse: [3, 0, -8]}]"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const double mass = Hdf5Reader(scene.out() / "mesh/ball.h5").vector("/mass").sum();
  const Steps steps(scene.out() / "sim/steps.csv");
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double share = std::clamp((steps("t_s", i) - 0.05) / 0.11, 0.0, 1.0);
    EXPECT_NEAR(mass * steps("vel_x_m_s", i), share * 3, 1e-6) << i;
    EXPECT_NEAR(mass * steps("vel_z_m_s", i), share * -8, 1e-6) << i;
    EXPECT_NEAR(steps("vel_y_m_s", i), -9.81 * steps("t_s", i), 1e-6) << i;
  }
}

TEST(Pushes, ThatCannotBeAreReportedWithTheirPlace) {
  TinyScene scene;
  scene.change("    mesh: ball.obj\n",
               "    mesh: ball.obj\n    spawn_s: 0.1\n    pushes: [{at_s: 0.05, impulse: [1, 0, 0]}]\n");
  const Outcome outcome = run("check", scene);
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(
      outcome.err,
      HasSubstr(":9:21: error: bodies[0].pushes[0].at_s = 0.05 s is before the body appears, at 0.1 s"));

  const Outcome flat = vivify({"check", VIVIFY_SOURCE_DIR "/configs/castle_solid.yaml", "--set",
                               "bodies.castle.pushes=[{at_s: 1, impulse: [1, 0, 1]}]"});
  EXPECT_EQ(flat.code, 2);
  EXPECT_THAT(flat.err, HasSubstr("bodies[0].pushes[0].impulse leads out of the plane"));

  const Outcome still = vivify({"check", VIVIFY_SOURCE_DIR "/configs/teacup.yaml", "--set", "physics=static",
                                "--set", "bodies.cup.pushes=[{at_s: 1, impulse: [1, 0, 1]}]"});
  EXPECT_EQ(still.code, 2);
  EXPECT_THAT(still.err, HasSubstr("bodies[0].pushes does not fit: physics = static"));
}

}  // namespace
}  // namespace vivify::pipeline
