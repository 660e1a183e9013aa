// Pins and moving handles: their potential, and bodies that hang from them, are carried by them and let go.
#include "sim/handles.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <filesystem>

#include "sim/control/rigid_motion.h"
#include "sim/solve/step_method.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

using testing::HasSubstr;

constexpr double kGravity = 9.81;
constexpr double kSag = 1e-5;  // of its height: how far a body that hangs from one handle sags
constexpr const char* kDamped = "{type: solid3d, stiffness: 60000, volume_stiffness: 60000, damping_s: 0.05}";

Region top() { return {"handles[0]", {0, 1, 0}, {1, 1, 1}}; }
Region bottom() { return {"handles[1]", {0, 0, 0}, {1, 0, 1}}; }

RigidKey key(double t, const Eigen::Vector3d& move = Eigen::Vector3d::Zero(),
             const Eigen::Vector3d& turns_deg = Eigen::Vector3d::Zero()) {
  return {t, move, turns_deg, {}};
}

// A passive box of 0.4 by 0.5 by 0.45 m that stands at height `y`.
BodyInput box(std::vector<Handle> handles, double y = 0) {
  TetMesh mesh = small_box();
  mesh.V.col(1).array() += y;
  BodyInput input = box_input(mesh, {.model = kDamped});
  input.handles = std::move(handles);
  return input;
}

double weight(const Body& body) { return kGravity * body.model().mass.sum(); }
double centre_height(const Body& body) { return centre_of_mass(body.model().mass, body.x()).y(); }

// Two handles that hold a body of every kind, at places where it is not.
class HoldOf : public ::testing::TestWithParam<BodyCase> {};
std::vector<BodyCase> one_space_cases() {
  std::vector<BodyCase> cases;
  for (const BodyCase& body : body_cases(elastic_models(), rest_spaces())) {
    if (body.space.name == "cage") cases.push_back(body);
  }
  return cases;
}
INSTANTIATE_TEST_SUITE_P(Every, HoldOf, ::testing::ValuesIn(one_space_cases()), case_name);

TEST_P(HoldOf, EntersPotentialForceAndStiffness) {
  const RandomStep step(GetParam(), {.model = ""}, 5, 1, 0.01);
  const BodyModel& body = step.body;
  const Handles handles({{top(), {}, RigidPath({key(0), key(1, {0.2, 0.1, 0}, {0, 0, 70})}, false)}},
                        body.mesh.V, body.weight / body.height);
  const Hold hold = handles.at(0.4, 0.1);
  ASSERT_FALSE(hold.springs().empty());
  const auto problem_with = [&](const Hold* held) {
    return StepProblem({{&body, &step.contacts, step.x, step.x, step.q, {}, held}}, nullptr, step.goals,
                       0.02);
  };
  const StepProblem held = problem_with(&hold), free = problem_with(nullptr);
  const RestPoint rest = held.rest_point(step.q, true);
  const auto at = [&](const Vector& x) { return held.deformed_point(x); };
  const auto residual = [&](const Vector& x) { return held.residual(at(x), rest); };
  const auto stiffness_of = [&](const StepProblem& problem, const Vector& x) {
    SymmetricMatrix D(*body.pattern);
    problem.stiffness(problem.deformed_point(x), rest, D);
    return dense(D);
  };

  // What the handle adds to the force and to the stiffness are the derivatives of its own energy, which is
  // quadratic, so that differences are exact.
  const auto own_energy = [&](const Vector& x) { return Vector::Constant(1, hold.energy(x)); };
  const auto own_force = [&](const Vector& x) { return Vector(residual(x) - free.residual(at(x), rest)); };
  const double unit = body.height;
  EXPECT_LE(relative(own_force(step.x).transpose(), differences(own_energy, step.x, 0.1 * unit)), 1e-9);
  const Matrix own_stiffness = stiffness_of(held, step.x) - stiffness_of(free, step.x);
  EXPECT_LE(relative(own_stiffness, differences(own_force, step.x, 0.1 * unit)), 1e-9);
  EXPECT_NEAR(held.potential(at(step.x), rest) - free.potential(at(step.x), rest), hold.energy(step.x),
              1e-12 * held.potential(at(step.x), rest));
  EXPECT_GT(own_stiffness.norm(), 0);
  // It never changes, so it has no part in block A.
  CounterRng rng(3);
  const Vector lambda = random_vector(step.x.size(), 1, rng);
  SymmetricMatrix A(*body.pattern), A_free(*body.pattern);
  held.block_A(at(step.x), rest, lambda, A);
  free.block_A(at(step.x), rest, lambda, A_free);
  EXPECT_EQ(dense(A), dense(A_free));

  const Eigen::Vector3d force = held.handle_force(0, at(step.x));
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const Vector nodal = own_force(step.x);
  for (Eigen::Index i = 0; i < body.mass.size(); ++i) sum -= spatial_point(nodal, i, body.dimension());
  EXPECT_LE((force - sum).norm(), 1e-9 * force.norm());
  EXPECT_EQ(free.handle_force(0, at(step.x)), Eigen::Vector3d::Zero());
}

// Both methods of the optimiser find the same optimum with a handle that pulls.
TEST(Handles, TheOptimizerSeesThem) {
  const RandomStep step(11, 1);
  const BodyModel& body = step.body;
  const Handles handles({{top(), {}, RigidPath({key(0), key(1, {0.05, 0, 0})}, false)}}, body.mesh.V,
                        body.weight / body.height);
  const Hold hold = handles.at(1, 0.02);
  const ContactSet no_contacts;
  const StepProblem problem({{&body, &no_contacts, step.x, step.x, step.q, {}, &hold}}, nullptr, step.goals,
                            0.02);
  std::vector<double> objectives;
  for (const StepMethodEntry& method : step_methods()) {
    StepWorkspace workspace(*body.pattern);
    const StepSolution solution = method.solve(problem, step.q, step.x, workspace);
    EXPECT_TRUE(solution.exact && solution.optimal) << method.name;
    EXPECT_LE(problem.relative_force(problem.residual(solution.at, solution.rest)), 1e-8) << method.name;
    objectives.push_back(solution.objective);
  }
  ASSERT_EQ(objectives.size(), 2u);
  EXPECT_NEAR(objectives[0], objectives[1], 1e-2 * objectives[1]);
}

TEST(Handles, HoldAtTheEndOfAStepOrOfItsPart) {
  const RigidPath path({key(0), key(1, {1, 2, 3}, {0, 90, 0})}, false);
  RowMatrixXd V(3, 3);
  V << 0, 0, 0, 1, 1, 0, 1, 1, 2;
  const Handles handles({{top(), Eigen::Vector3d(0, 1, 0), path, 0.5}}, V, 1);
  for (const double end : {0.1, 0.25, 0.5}) {
    const Hold hold = handles.at(end, 0.25);
    ASSERT_EQ(hold.springs().size(), 2u);
    const Eigen::Vector3d about(0, 1, 0);
    EXPECT_EQ(hold.springs()[1].vertex, 2);
    const Eigen::Vector3d place = about + path.pose(end) * Eigen::Vector3d(1, 0, 2);
    EXPECT_LE((hold.springs()[1].place - place).norm(), 1e-15);
  }
  EXPECT_EQ(handles.at(0.5 + 1e-12, 0.25).springs().size(), 2u) << "rounding of the time";
  EXPECT_TRUE(handles.at(0.51, 0.25).springs().empty());
  // The middle of the part is where it turns when nothing is said.
  const Handles own({{top(), {}, RigidPath({key(0), key(1, {0, 0, 0}, {0, 90, 0})}, false)}}, V, 1);
  EXPECT_LE((own.at(1, 1).springs()[1].place - Eigen::Vector3d(2, 1, 1)).norm(), 1e-15);
  EXPECT_LE((own.at(1, 1).springs()[0].place - Eigen::Vector3d(0, 1, 1)).norm(), 1e-15);
}

TEST(Handles, SayWhatIsWrong) {
  const auto failure = [](std::vector<Handle> handles) -> Error {
    try {
      World({box(std::move(handles))}, {}, {});
    } catch (const Error& error) {
      return error;
    }
    return {ErrorKind::internal, "nothing was thrown"};
  };
  Handle nothing{{"bodies[0].handles[0]", {0.1, 0.1, 0.1}, {0.2, 0.2, 0.2}}};
  nothing.region.where = {"scene.yaml", 7, 5};
  const Error empty = failure({nothing});
  EXPECT_EQ(empty.kind(), ErrorKind::usage);
  EXPECT_THAT(empty.full_text(),
              HasSubstr("scene.yaml:7:5: error: bodies[0].handles[0] takes hold of no vertex"));
  Handle side{{"handles[1]", {0, 0, 0}, {0, 1, 1}}};
  EXPECT_THAT(failure({{top()}, side}).what(),
              HasSubstr("handles[0] and handles[1] both take hold of vertex"));
}

// Every step obeys M a = M g + F, and in the end F is the weight.
class HangingBody : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Models, HangingBody, ::testing::Values("solid3d", "shell3d", "solid2d", "rod2d"),
                         [](const auto& tested) { return tested.param; });

TEST_P(HangingBody, PullsWithItsWeight) {
  const BodyCase tested = [&] {
    for (const BodyCase& body : one_space_cases()) {
      if (body.model.name == GetParam()) return body;
    }
    throw std::logic_error("no such model");
  }();
  BodyInput input = body_input(tested, {.model = "damping_s: 0.05"});
  input.handles = {{{"handles[0]", {0, 0.5, 0}, {1, 1, 1}}}};
  World world({input}, {}, {});
  const double M = world.body(0).model().mass.sum();
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  for (int step = 0; step < 300; ++step) {
    world.step();
    const StepRecord& r = world.records().back();
    const Eigen::Vector3d force = M * ((r.vel - before) * 48 + kGravity * Eigen::Vector3d::UnitY());
    ASSERT_LE((r.handle_force - force).norm(), 1e-7 * M * kGravity) << "step " << step;
    before = r.vel;
  }
  const Body& body = world.body(0);
  EXPECT_NEAR(world.records().back().handle_force.y(), weight(body), 1e-3 * weight(body));
  // It hangs as high as it should.
  const Vector rest = flat(body.model().mesh.V);
  const int d = body.model().dimension();
  const Hold hold = body.handles().at(1, 0.02);
  double held = 0;
  for (const Hold::Spring& spring : hold.springs())
    held += body.x()[d * spring.vertex + 1] - rest[d * spring.vertex + 1];
  EXPECT_NEAR(held / static_cast<double>(hold.springs().size()), -kSag * body.model().height,
              1e-2 * kSag * body.model().height);
}

// A pinned box bears another one that rests on it.
TEST(Handles, BearWhatRestsOnTheBody) {
  BodyInput shelf = box({{bottom()}}), load = box({}, 0.5005);
  shelf.name = "shelf";
  load.name = "load";
  World world({load, shelf}, {}, {});
  for (int step = 0; step < 200; ++step) world.step();
  ASSERT_EQ(world.islands().size(), 1u);
  const double both = weight(world.body(0)) + weight(world.body(1));
  const StepRecord &of_load = world.records()[398], &of_shelf = world.records()[399];
  EXPECT_NEAR(of_shelf.handle_force.y(), both, 1e-3 * both);
  EXPECT_EQ(of_load.handle_force, Eigen::Vector3d::Zero());
  EXPECT_LE(of_load.vel.norm(), 1e-3);
  EXPECT_LE(of_shelf.residual_rel, 1e-8);
}

TEST(Handles, CarryABodyThatMovesAndTurns) {
  const RigidPath path({key(0), key(2, {1.5, 0.6, -0.8}, {0, 120, 30})}, false);
  World world({box({{bottom(), {}, path}})}, {}, {});
  const Body& body = world.body(0);
  double worst = 0;
  for (int step = 1; step <= 192; ++step) {
    world.step();
    EXPECT_LE(world.records().back().residual_rel, 1e-8);
    const Hold hold = body.handles().at(step / 48.0, 1 / 48.0);
    for (const Hold::Spring& spring : hold.springs())
      worst = std::max(worst, (spatial_point(body.x(), spring.vertex, 3) - spring.place).norm());
  }
  EXPECT_LE(worst, 1e-3 * body.model().height);
  // At rest again the body stands on its turned foot as on the ground.
  EXPECT_LE(body.v().lpNorm<Eigen::Infinity>(), 1e-2);
  const Matrix turned = best_rotation(body.model().mass, flat(body.model().mesh.V), body.x());
  EXPECT_LE((turned - path.pose(2).linear()).norm(), 0.1);
}

TEST(Handles, LetGoAtTheirTime) {
  const double h = 1.0 / 48;
  World world({box({{top(), {}, {}, 0.5}}, 10)}, {}, {});
  for (int step = 0; step < 24; ++step) world.step();
  EXPECT_GT(world.records().back().handle_force.y(), 0.5 * weight(world.body(0)));
  const Body& body = world.body(0);
  Eigen::Vector3d velocity = world.records().back().vel, place = world.records().back().com;
  for (int step = 0; step < 24; ++step) {
    world.step();
    const StepRecord& r = world.records().back();
    EXPECT_EQ(r.handle_force, Eigen::Vector3d::Zero());
    velocity.y() -= h * kGravity;  // the parabola of implicit Euler
    place += h * velocity;
    EXPECT_LE((r.com - place).norm(), 1e-9) << "step " << step;
  }
  EXPECT_LT(centre_height(body), 9.2);
}

TEST(Handles, RestartToTheBitWhileTheyHold) {
  const auto file =
      std::filesystem::temp_directory_path() / ("vivify_handles_" + std::to_string(getpid()) + ".h5");
  const auto make = [] {
    BodyInput input =
        box_input(small_box(), {.controller = "{type: hop, height: 0.1, pace: 0.3, crouch_s: 0.1}"});
    input.handles = {{bottom(), {}, RigidPath({key(0), key(0.4, {0.2, 0.1, 0}, {0, 20, 0})}, false), 0.6}};
    return World({input}, one(plane(1)), {});
  };
  World whole = make(), cut = make();
  std::vector<std::string> lines;
  for (int step = 0; step < 40; ++step) {
    whole.step();
    lines.push_back(csv_line(whole.records().back()));
    if (step < 13) cut.step();
  }
  Hdf5Writer saved;
  cut.save(saved);
  saved.save(file);
  World resumed = make();
  resumed.restore(Hdf5Reader(file));
  std::filesystem::remove(file);
  int held = 0;
  for (std::size_t step = 13; step < 40; ++step) {
    resumed.step();
    EXPECT_EQ(csv_line(resumed.records().back()), lines[step]) << step;
    held += resumed.records().back().handle_force.norm() > 0 ? 1 : 0;
  }
  EXPECT_EQ(held, 28 - 13);
  EXPECT_EQ(resumed.body(0).x(), whole.body(0).x());
}

// A thin shell torn along by a handle, so that steps are cut: the parts are those of smaller steps.
TEST(Handles, AreWhereTheyShouldBeInThePartsOfAStep) {
  const double h = 0.05;
  const auto world = [](double step_size, double speed) {
    const ModelEntry& model = model_entry(settings(model_schema(), "{type: shell3d}"));
    BodyInput input = body_input({model, rest_space_entry("cage"), small_meshes(3, 3)[1]});
    input.handles = {{top(), {}, RigidPath({key(0), key(1, {speed, 0.5 * speed, 0})}, false)}};
    return World({input}, {}, {.h = step_size});
  };
  int split = 0;
  for (std::uint64_t seed = 0; seed < 20 && split < 2; ++seed) {
    World whole = world(h, 60);
    CounterRng rng(seed);
    const Vector v = random_vector(whole.body(0).x().size(), 100, rng);
    const Vector x = whole.body(0).x();
    set_motion(whole, x, v);
    whole.step();
    const StepRecord r = whole.records().back();
    if (r.substeps == 1) continue;
    ++split;
    World parts = world(h / r.substeps, 60);
    set_motion(parts, x, v);
    for (int k = 0; k < r.substeps; ++k) parts.step();
    EXPECT_LE((whole.body(0).x() - parts.body(0).x()).norm(), 1e-9 * x.norm()) << "seed " << seed;
    EXPECT_LE((r.handle_force - parts.records().back().handle_force).norm(), 1e-6 * r.handle_force.norm());
  }
  EXPECT_GE(split, 1);
}

}  // namespace
}  // namespace vivify::sim
