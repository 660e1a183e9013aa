// Every model under every controller: steps that solve the equations of motion, and restarts to the bit; and
// steps that cannot be solved whole.
#include <unistd.h>

#include <filesystem>

#include "tests/sim/conformance.h"

namespace vivify::sim {
namespace {

struct Driven {
  BodyCase body;
  std::string controller;
};

std::vector<Driven> driven_bodies() {
  std::vector<Driven> bodies;
  for (const ControllerEntry& controller : controllers()) {
    // Some need examples; the others may use any rest space.
    const bool keyed = controller.name == "blend", poses = controller.name == "pose",
               goals = controller.name == "goals", walks = controller.name == "walk",
               heads = controller.name == "hop" || controller.name == "roll";
    const bool crawls = controller.name == "crawl";
    const bool turns = controller.name == "turn";  // about the vertical
    for (const ModelEntry& model : elastic_models()) {
      if (turns && model.dimension == 2) continue;
      for (const NamedMesh& mesh : small_meshes(model.dimension, model.element_points)) {
        const std::string settings =
            keyed    ? ", keys: [{t: 0, weights: [0, 0, 0]}, {t: 0.3, weights: [0.3, 0.1, 0.4]}]"
            : poses  ? ", example: bent"
            : turns  ? ", by_deg: 90"
            : crawls ? ", heading_deg: 90, segments: 2"
            : heads  ? ", heading_deg: 90"
            : goals  ? ", goals: [{frequency: 4, keys: [{value: -0.05}]}]"
            : walks  ? ", heading_deg: 90, feet: [{min: [0, 0, 0], max: [0.4, 0.4, 1]}, {min: [0.6, 0, 0], "
                       "max: [1, 0.4, 1]}]"
                     : "";
        bodies.push_back({{model, rest_space_entry(keyed || poses ? "examples" : "cage"), mesh},
                          "{type: " + std::string(controller.name) + settings + "}"});
      }
    }
  }
  return bodies;
}

void PrintTo(const Driven& driven, std::ostream* out) { PrintTo(driven.body, out); }

class WorldConformance : public ::testing::TestWithParam<Driven> {
 protected:
  World world() const {
    const auto& [body, controller] = GetParam();
    return {{body_input(body, {.model = "damping_s: 0.001", .controller = controller})}, one(plane(0.8)), {}};
  }
};

INSTANTIATE_TEST_SUITE_P(Every, WorldConformance, ::testing::ValuesIn(driven_bodies()),
                         [](const auto& tested) {
                           const std::string& controller = tested.param.controller;
                           return std::string(tested.param.body.model.name) + "_" +
                                  tested.param.body.mesh.name + "_" +
                                  controller.substr(7, controller.find_first_of(",}") - 7);
                         });

TEST_P(WorldConformance, StepsAreSolvedAndKeepMomentum) {
  World run = world();
  const BodyModel& model = run.body(0).model();
  for (int step = 0; step < 12; ++step) {
    run.step();
    const StepRecord& r = run.records().back();
    EXPECT_LE(r.residual_rel, 1e-10) << step;
    EXPECT_LE(r.internal_force, 1e-9 * model.weight) << step;
    EXPECT_LE(r.internal_torque, 1e-9 * model.weight * model.height) << step;
    EXPECT_GT(r.min_element_ratio, 0.05) << step;
    EXPECT_LE(r.max_penetration, 0.02 * model.height) << step;
  }
  if (GetParam().controller == "{type: rest}") {
    EXPECT_EQ(run.records().back().p_norm, 0);
  } else if (GetParam().controller != "{type: wait}") {  // who stands well needs to do nothing
    EXPECT_GT(run.records().back().p_norm, 0) << "the controller acts";
  }
}

TEST_P(WorldConformance, RestartsToTheBit) {
  World first = world(), again = world();
  for (int step = 0; step < 5; ++step) first.step();
  const auto path = std::filesystem::temp_directory_path() /
                    ("vivify_world_conformance_" + std::to_string(getpid()) + ".h5");
  Hdf5Writer saved;
  first.save(saved);
  saved.save(path);
  again.restore(Hdf5Reader(path));
  std::filesystem::remove(path);
  EXPECT_EQ(again.steps(), 5);
  for (int step = 0; step < 5; ++step) {
    first.step();
    again.step();
    ASSERT_EQ(first.body(0).x(), again.body(0).x());
    ASSERT_EQ(first.body(0).v(), again.body(0).v());
    ASSERT_EQ(first.body(0).p(), again.body(0).p());
    ASSERT_EQ(csv_line(first.records().back()), csv_line(again.records().back()));
  }
}

// A closed shell torn about so violently that some steps cannot be solved whole.
class Splitting : public ::testing::Test {
 protected:
  static World shell(double h) {
    const ModelEntry& model = model_entry(settings(model_schema(), "{type: shell3d}"));
    return {{body_input({model, rest_space_entry("cage"), small_meshes(3, 3)[1]})}, {}, {.h = h}};
  }
  static void tear(World& world, double speed, std::uint64_t seed) {
    CounterRng rng(seed);
    const Vector x = world.body(0).x();
    set_motion(world, x, random_vector(x.size(), speed, rng));
  }
};

TEST_F(Splitting, AStepThatCannotBeSolvedWholeIsThoseOfItsParts) {
  const double h = 0.05;
  int split = 0;
  for (std::uint64_t seed = 0; seed < 20 && split < 2; ++seed) {
    World whole = shell(h);
    tear(whole, 100, seed);
    whole.step();
    const StepRecord r = whole.records().back();
    EXPECT_LE(r.residual_rel, 1e-10);
    if (r.substeps == 1) continue;
    ++split;
    EXPECT_NEAR(r.t, h, 1e-15);
    World parts = shell(h / r.substeps);
    tear(parts, 100, seed);
    for (int k = 0; k < r.substeps; ++k) parts.step();
    EXPECT_EQ(whole.body(0).x(), parts.body(0).x()) << "seed " << seed;
    EXPECT_EQ(whole.body(0).v(), parts.body(0).v()) << "seed " << seed;
  }
  EXPECT_GE(split, 1);
}

TEST_F(Splitting, AStepThatCannotBeSolvedAtAllNamesBodyAndStep) {
  World world = shell(0.05);
  world.step();
  world.step();
  tear(world, 1e160, 1);  // its energy is not finite
  const Vector x = world.body(0).x(), v = world.body(0).v();
  try {
    world.step();
    FAIL() << "the step was taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::numerical);
    const std::string text = error.what();
    EXPECT_NE(text.find("'box'"), std::string::npos) << text;
    EXPECT_NE(text.find("step 3:"), std::string::npos) << text;
    EXPECT_FALSE(error.hint().empty());
  }
  EXPECT_EQ(world.body(0).x(), x);
  EXPECT_EQ(world.body(0).v(), v);
}

}  // namespace
}  // namespace vivify::sim
