// Random scenes are simulated with finite numbers and exact physics, or end with a message that helps.
#include "tests/sim/random_scene.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <iostream>

namespace vivify::sim {
namespace {

INSTANTIATE_TEST_SUITE_P(Few, RandomScenes, ::testing::Range<std::uint64_t>(0, 20));

bool finite(const StepRecord& r) {
  for (const double value :
       {r.t, r.residual_rel, r.objective, r.p_norm, r.p_rate, r.internal_force, r.internal_torque,
        r.max_penetration, r.min_element_ratio, r.kinetic, r.elastic, r.tilt_deg}) {
    if (!std::isfinite(value)) return false;
  }
  return r.com.allFinite() && r.vel.allFinite() && !std::isnan(r.min_clearance);
}

TEST_P(RandomScenes, AreSimulatedOrSayWhyNot) {
  const RandomScene scene = random_scene(GetParam());
  const double h = scene.settings.h;
  const RandomRun run = simulate(random_scene(GetParam()));
  SCOPED_TRACE(scene.text);
  ASSERT_TRUE(run.x.allFinite() && run.v.allFinite());
  const double gravity = scene.settings.gravity.norm();
  for (std::size_t i = 0; i < run.records.size(); ++i) {
    const StepRecord& r = run.records[i];
    ASSERT_TRUE(finite(r)) << csv_line(r);
    EXPECT_LE(r.residual_rel, 1e-8) << "step " << r.step;
    // Sums of forces that cancel: exact to rounding of the forces, which may be far above the weight.
    const double forces =
        run.weight + (std::sqrt(r.kinetic * run.weight / gravity) / h) + r.elastic / run.height;
    EXPECT_LE(r.internal_force, 1e-9 * forces) << "step " << r.step;
    EXPECT_LE(r.internal_torque, 1e-9 * forces * run.height) << "step " << r.step;
    if (i == 0 || r.contacts > 0 || run.records[i - 1].contacts > 0 || r.substeps > 1) continue;
    const StepRecord& before = run.records[i - 1];
    const Eigen::Vector3d vel = before.vel + h * scene.settings.gravity, com = before.com + h * vel;
    EXPECT_LE((r.vel - vel).norm(), 1e-8 * (1 + vel.norm())) << "step " << r.step;
    EXPECT_LE((r.com - com).norm(), 1e-8 * (1 + com.norm())) << "step " << r.step;
  }
  if (run.error.empty()) {
    EXPECT_EQ(run.records.size(), static_cast<std::size_t>(scene.steps));
  } else {
    EXPECT_NE(run.error.find("'" + scene.body.name + "'"), std::string::npos) << run.error;
    EXPECT_NE(run.error.find("step " + std::to_string(run.records.size() + 1)), std::string::npos)
        << run.error;
    EXPECT_NE(run.hint.find("steps_per_frame"), std::string::npos) << run.hint;
    RecordProperty("error", run.error);
    std::cout << "[ GIVES UP ] scene " << GetParam() << " (" << scene.text << "): " << run.error << '\n';
  }
  const double slowest = *std::max_element(run.seconds.begin(), run.seconds.end());
  RecordProperty("slowest_step_ms", static_cast<int>(1000 * slowest));
}

// A hinge has no balance of forces where one of its triangles is a line: its angle jumps there. Shells that
// are thrown about hard enough get stuck at such a place.
TEST(SqueezedElements, AreNamed) {
  const RandomScene scene = random_scene(194);
  ASSERT_THAT(scene.text, ::testing::HasSubstr("shell3d"));
  EXPECT_THAT(simulate(random_scene(194)).error,
              ::testing::ContainsRegex("with triangle [0-9]+ squeezed to [0-9.e-]+ % of its size at rest"));
}

// What cannot be simulated at all is refused at once, and the message names the place.
TEST(BadMeshes, AreRefused) {
  const BodyInput good = box_input(small_box());
  const auto refusal = [&](const auto& spoil) -> std::string {
    BodyInput bad = good;
    spoil(bad.rest);
    try {
      Body(bad, WorldSettings{});
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::geometry);
      return error.what();
    }
    return "not refused";
  };
  const auto has = [](const char* text) { return ::testing::HasSubstr(text); };
  EXPECT_THAT(refusal([](SimMesh& mesh) { mesh.V(5, 1) = NAN; }), has("'box': vertex 5"));
  EXPECT_THAT(refusal([](SimMesh& mesh) { mesh.V(6, 0) = INFINITY; }), has("vertex 6"));
  EXPECT_THAT(refusal([](SimMesh& mesh) { mesh.E(3, 2) = 27; }),
              has("element 3 of the simulation mesh has vertex 27"));
  EXPECT_THAT(refusal([](SimMesh& mesh) { mesh.E(4, 0) = -1; }), has("vertex -1"));
  EXPECT_THAT(refusal([](SimMesh& mesh) { mesh.E.resize(0, 4); }), has("no elements"));
  EXPECT_THAT(refusal([](SimMesh& mesh) { mesh.V.row(mesh.E(2, 1)) = mesh.V.row(mesh.E(2, 0)); }),
              has("tetrahedron"));
  EXPECT_THAT(refusal([](SimMesh& mesh) {
                mesh.V.conservativeResize(28, 3);
                mesh.V.row(27).setZero();
              }),
              has("vertex 27 of the simulation mesh belongs to no element"));
}

}  // namespace
}  // namespace vivify::sim
