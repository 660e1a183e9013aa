// What control costs, in ratios that do not depend on the machine, all from one run:
//   an iteration of the optimiser over one numeric factorisation of D with its n_g + 2 triangular solves, and
//   a controlled over a passive step.
//   sim_bench [OUT]
// OUT is a folder that `vivify weights` filled: its first body is taken, else generated ones. A body runs
// with its controller; at some of its states the parts of an iteration are timed by calling the public
// functions, and the step itself is taken again several times, with the controller and with the rest shape
// held as it is (p fixed), in turn.
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/bodies.h"
#include "bench/timing.h"
#include "common/file.h"
#include "common/hdf5_file.h"
#include "common/memory.h"
#include "common/text.h"
#include "sim/contact/contact_points.h"
#include "sim/settings.h"
#include "sim/world.h"

using namespace vivify;
using namespace vivify::sim;
using namespace vivify::bench;

namespace {

constexpr double kSeconds = 2;
constexpr int kAlternations = 5;
constexpr int kStates = 24;
constexpr double kShortest = 2e-4;  // s; shorter works are repeated until they take this long together

struct Case {
  BodyInput input;
  WorldSettings settings;
};

const ConfigNode& entry(const ConfigNode& map, const std::string& key) {
  for (const ConfigNode::Entry& found : map.entries) {
    if (found.key == key) return found.value;
  }
  throw Error(ErrorKind::usage, "the resolved scene has no '" + key + "'");
}

Value resolved(const Schema& schema, const ConfigNode& node) {
  std::vector<Error> errors;
  Value value = resolve(schema, node, errors);
  if (!errors.empty()) throw errors.front();
  return value;
}

// The first body of a run, standing on y = 0, and the step size of its scene.
Case load_body(const std::filesystem::path& out) {
  std::vector<Error> errors;
  const std::string file = (out / "scene.resolved.yaml").string();
  const ConfigNode scene = parse_yaml(read_text_file(file), file, errors);
  if (!errors.empty()) throw errors.front();
  const ConfigNode& body = entry(scene, "bodies").items.at(0);
  Case loaded;
  BodyInput& input = loaded.input;
  input.name = entry(body, "name").scalar;
  input.model = resolved(model_schema(), entry(body, "model"));
  input.regularizer = resolved(regularizer_schema(), entry(body, "regularizer"));
  input.contact = resolved(contact_schema(), entry(body, "contact"));
  input.solver = resolved(solver_schema(), entry(body, "solver"));
  input.controller = resolved(controller_schema(), entry(body, "controller"));
  const Hdf5Reader mesh(out / "mesh" / (input.name + ".h5"));
  input.rest.V = mesh.matrix("/X0");
  input.rest.E = mesh.int_matrix("/elements");
  input.cage_weights = Hdf5Reader(out / "weights" / (input.name + ".h5")).matrix("/weights");
  const Eigen::VectorXi element = mesh.int_vector("/embedding/element");
  RowMatrixXi corners(element.size(), input.rest.E.cols());
  for (Eigen::Index i = 0; i < element.size(); ++i) corners.row(i) = input.rest.E.row(element[i]);
  Points surface = mesh.matrix("/surface/V");
  const double low = input.rest.V.col(1).minCoeff();
  surface.col(1).array() -= low;
  input.rest.V.col(1).array() -= low;
  input.contact_points =
      select_contact_points(surface, corners, mesh.matrix("/embedding/weights"), input.rest.dimension(),
                            static_cast<int>(input.contact["points"].as_integer()));
  const ConfigNode& frames = entry(scene, "frames");
  loaded.settings.h =
      1 / (std::stod(entry(frames, "fps").scalar) * std::stod(entry(frames, "steps_per_frame").scalar));
  return loaded;
}

std::vector<Case> generated() {
  const std::string hop = "{type: hop, heading_deg: 90, height: 0.2, pace: 0.5}";
  const auto solid = [](const std::string& name, const SimMesh& mesh, const std::string& controller) {
    return Case{body_input(name, mesh, lively_model("solid3d", mesh), controller), {}};
  };
  std::vector<Case> cases;
  cases.push_back(solid("ball", ball(0.4, 2, 1), "{type: roll, heading_deg: 90}"));
  cases.push_back(solid("box", box(3, 6, 2, 0.16), hop));
  cases.push_back(solid("box", box(4, 4, 4, 0.25), hop));
  cases.push_back(solid("box", box(5, 8, 6, 0.125), hop));
  cases.push_back(solid("cross", cross(2, {7, 6, 7, 6, 7, 6}, 0.07), hop));
  BodyInput& legs = cases.back().input;
  legs.rest_space = "examples";
  legs.examples = waves(legs.rest.V, 6);
  return cases;
}

struct State {
  Eigen::VectorXd x, v, q;
};

// Seconds of the parts of one iteration of the optimiser, at one state.
struct Parts {
  double iteration, factorisation, assembly, regularizer;
};

Parts time_parts(const BodyModel& body, const std::vector<Collider>& colliders, const State& state,
                 double h) {
  StepWorkspace workspace(*body.pattern);
  const std::vector<ContactMemory> memory(static_cast<std::size_t>(body.contact_points.size()));
  const ContactSet contacts(body.contact_points, body.contact, colliders, state.x, 0.1 * body.height, memory);
  const int d = body.dimension();
  std::vector<Goal> wanted;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d direction = Eigen::Vector3d::Unit(axis);
    wanted.push_back({centre_of_mass_weights(body.mass, direction, d), 0, std::sqrt(body.mass.sum()), 0, 1});
    wanted.push_back({spin_weights(body.mass, state.x, direction), 0, std::sqrt(body.mass.sum()), 0, 0});
  }
  const Goals goals = make_goals(wanted, state.x, h);
  const StepProblem problem(body, contacts, goals, state.x, state.x + h * state.v, state.q, h);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(state.x.size());
  Eigen::MatrixXd rhs(zero.size(), goals.size() + 2);
  rhs << goals.G.transpose(), zero, zero;
  DeformedPoint at = problem.deformed_point(state.x);
  RestPoint rest = problem.rest_point(state.q, true);
  const Eigen::VectorXd c = problem.residual(at, rest);
  double sink = 0;

  // One accepted iteration of the SQP: linearise (c is known from the last trial), solve, one trial,
  // derivatives at the new point.
  const auto iteration = [&] {
    const BlockSolver block(problem, at, rest, c, false, workspace);
    if (!block.definite()) return;
    sink += block.decrement();
    const Eigen::VectorXd dq = block.step_q(0), dx = block.step_x(dq);
    const RestPoint trial_rest = problem.rest_point(rest.q + dq, false);
    const DeformedPoint trial = problem.deformed_point(at.x + dx);
    sink += problem.residual(trial, trial_rest).sum() + problem.objective(trial.x, trial_rest) +
            problem.smallest_element(trial);
    const RestPoint next = problem.rest_point(trial_rest.q, true);
    sink += next.regularizer;
  };
  const auto factorisation = [&] {
    if (workspace.solver.factorize(workspace.D)) sink += workspace.solver.solve(rhs)(0, 0);
  };
  const auto assembly = [&] {
    at = problem.deformed_point(state.x);
    sink += problem.residual(at, rest).sum();
    problem.stiffness(at, rest, workspace.D);
  };
  const auto regularizer = [&] {
    rest = problem.rest_point(state.q, true);
    sink += problem.regularizer_gradient(rest).sum() + problem.regularizer_gauss_newton(rest).sum();
  };
  std::vector<double> times[4];
  assembly();
  const int repeats = 1 + static_cast<int>(kShortest / std::max(1e-7, seconds_of(factorisation)));
  const auto repeated = [&](const auto& work) {
    return seconds_of([&] {
             for (int repeat = 0; repeat < repeats; ++repeat) work();
           }) /
           repeats;
  };
  for (int alternation = 0; alternation < kAlternations; ++alternation) {
    times[0].push_back(repeated(assembly));
    times[1].push_back(repeated(factorisation));
    times[2].push_back(repeated(regularizer));
    times[3].push_back(repeated(iteration));
  }
  if (!std::isfinite(sink)) throw Error(ErrorKind::numerical, "an iteration gave no number");
  return {median(times[3]), median(times[1]), median(times[0]), median(times[2])};
}

// The body with its rest shape held at p.
BodyInput held(const BodyInput& input, const Eigen::VectorXd& p) {
  BodyInput still = input;
  std::string weights;
  for (Eigen::Index i = 0; i < p.size(); ++i) weights += (i > 0 ? ", " : "") + number_text(p[i]);
  still.controller =
      bench::settings(controller_schema(), "{type: blend, keys: [{t: 0, weights: [" + weights + "]}]}");
  return still;
}

void run(const Case& tested) {
  const BodyInput& input = tested.input;
  const WorldSettings& settings = tested.settings;
  const int steps = static_cast<int>(std::lround(kSeconds / settings.h));
  const int interval = std::max(1, steps / kStates);
  const std::filesystem::path saved =
      std::filesystem::temp_directory_path() / ("vivify_sim_bench_" + std::to_string(getpid()) + ".h5");

  World world({input}, ground(), settings);
  const Body& body = world.body(0);
  const BodyModel& model = body.model();
  const std::vector<Collider> colliders = ground();
  std::vector<double> iterations, tilt, iteration, factorisation, assembly, regularizer, over;
  std::vector<double> all_controlled, controlled, passive, ratio;
  for (int step = 0; step < steps; ++step) {
    if (step % interval == interval / 2) {
      const State state{body.x(), body.v(), model.rest->basis().transpose() * body.p()};
      const Parts parts = time_parts(model, colliders, state, settings.h);
      iteration.push_back(parts.iteration);
      factorisation.push_back(parts.factorisation);
      assembly.push_back(parts.assembly);
      regularizer.push_back(parts.regularizer);
      over.push_back(parts.iteration / parts.factorisation);

      Hdf5Writer file;
      world.save(file);
      file.save(saved);
      const Hdf5Reader reader(saved);
      World with({input}, ground(), settings), without({held(input, body.p())}, ground(), settings);
      std::vector<double> times[2];
      for (int alternation = 0; alternation < kAlternations; ++alternation) {
        with.restore(reader);
        times[0].push_back(seconds_of([&] { with.step(); }));
        without.restore(reader);
        times[1].push_back(seconds_of([&] { without.step(); }));
      }
      controlled.push_back(median(times[0]));
      passive.push_back(median(times[1]));
      ratio.push_back(controlled.back() / passive.back());
    }
    all_controlled.push_back(seconds_of([&] { world.step(); }));
    iterations.push_back(world.records().back().iterations);
    tilt.push_back(world.records().back().tilt_deg);
  }
  std::filesystem::remove(saved);

  BodyInput alone = input;
  alone.controller = bench::settings(controller_schema(), "{}");
  World resting({alone}, ground(), settings);
  std::vector<double> all_passive;
  for (int step = 0; step < steps; ++step) all_passive.push_back(seconds_of([&] { resting.step(); }));

  const double whole = median(iteration);
  const auto share = [&](const std::vector<double>& part) { return 100 * median(part) / whole; };
  const int solves = (model.dimension() == 3 ? 6 : 3) + 2;
  std::printf("%s: %d degrees of freedom, %d parameters (%d free), %s, %s\n", input.name.c_str(),
              model.dofs(), model.rest->parameters(), model.rest->free_parameters(), input.rest_space.c_str(),
              input.controller["type"].as_string().c_str());
  std::printf("  elements, contact points               %d, %d\n", static_cast<int>(model.mesh.E.rows()),
              model.contact_points.size());
  std::printf("  steps of 1/%.0f s, iterations each       %d, mean %.2f, p95 %.0f\n", 1 / settings.h, steps,
              mean(iterations), quantile(iterations, 0.95));
  std::printf("  tilt, median and largest               %.0f°, %.0f°\n", median(tilt), quantile(tilt, 1));
  std::printf("  one iteration                          %.3f ms\n", 1e3 * whole);
  std::printf("  over factorisation of D + %d solves     %.2f\n", solves, median(over));
  std::printf("    factorisation and solves             %.0f %%\n", share(factorisation));
  std::printf("    assembly of c and D                  %.0f %%\n", share(assembly));
  std::printf("    rest shape and its regulariser       %.0f %%\n", share(regularizer));
  std::printf("    the remainder                        %.0f %%\n",
              100 - share(factorisation) - share(assembly) - share(regularizer));
  std::printf("  controlled over passive step           %.2f  (p fixed, the same %d states; means)\n",
              mean(controlled) / mean(passive), static_cast<int>(ratio.size()));
  std::printf("    of single states, median and p95     %.2f, %.2f\n", median(ratio), quantile(ratio, 0.95));
  std::printf("    over a passive body on its own       %.2f\n", mean(all_controlled) / mean(all_passive));
  std::printf("  seconds per simulated second           %.3f controlled, %.3f passive with p fixed\n\n",
              mean(all_controlled) / settings.h, mean(passive) / settings.h);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  vivify::keep_freed_memory();
  try {
    if (argc > 1) {
      run(load_body(argv[1]));
    } else {
      for (const Case& tested : generated()) run(tested);
    }
    return 0;
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.full_text().c_str());
    return exit_code(error.kind());
  }
}
