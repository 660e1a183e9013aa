// Cost of the controlled step, in ratios that do not depend on the machine.
//   sim_bench [OUT [SECONDS]]
// OUT is a folder that `vivify weights` filled: its first body is used, else a box of 360 degrees of freedom.
// Every figure comes from this one run. Times of the parts are taken by calling the public functions on
// states of the run.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/file.h"
#include "common/hdf5_file.h"
#include "sim/contact/contact_points.h"
#include "sim/settings.h"
#include "sim/world.h"

using namespace vivify;
using namespace vivify::sim;

namespace {

constexpr int kAlternations = 5;
constexpr int kStateInterval = 6;  // steps between captured states

double seconds_of(const std::function<void()>& work) {
  const auto now = [] {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  };
  const double begin = now();
  work();
  return now() - begin;
}

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const double rank = std::ceil(share * static_cast<double>(values.size()));
  return values[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}
double median(const std::vector<double>& values) { return quantile(values, 0.5); }
double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

const ConfigNode& entry(const ConfigNode& map, const std::string& key) {
  for (const ConfigNode::Entry& found : map.entries) {
    if (found.key == key) return found.value;
  }
  throw Error(ErrorKind::usage, "the resolved scene has no '" + key + "'");
}

Value settings(const Schema& schema, const ConfigNode& node) {
  std::vector<Error> errors;
  Value value = resolve(schema, node, errors);
  if (!errors.empty()) throw errors.front();
  return value;
}

// 4 by 6 by 5 vertices, each cell cut into six tetrahedra around its diagonal, with the corners of a box as
// the cage.
void make_box(BodyInput& input) {
  input.name = "box";
  input.model = settings(model_schema(), {});
  input.regularizer = settings(regularizer_schema(), {});
  input.contact = settings(contact_schema(), {});
  input.solver = settings(solver_schema(), {});
  std::vector<Error> errors;
  input.controller = settings(controller_schema(), parse_yaml("{type: hop}", "bench", errors));
  static constexpr int kOrder[6][3] = {{1, 2, 4}, {2, 4, 1}, {4, 1, 2}, {1, 4, 2}, {2, 1, 4}, {4, 2, 1}};
  const int nodes[3] = {4, 6, 5};
  const auto index = [&](int i, int j, int k) { return i + nodes[0] * (j + nodes[1] * k); };
  input.rest.V.resize(120, 3);
  input.cage_weights.resize(120, 8);
  for (int k = 0; k < nodes[2]; ++k) {
    for (int j = 0; j < nodes[1]; ++j) {
      for (int i = 0; i < nodes[0]; ++i) {
        const Eigen::Vector3d share(i / 3.0, j / 5.0, k / 4.0);
        input.rest.V.row(index(i, j, k)) << 0.8 * share.x() - 0.4, share.y(), 0.8 * share.z() - 0.4;
        const Eigen::Vector3d t = (share.array() + 0.1) / 1.2;
        for (int c = 0; c < 8; ++c) {
          input.cage_weights(index(i, j, k), c) =
              (c & 1 ? t.x() : 1 - t.x()) * (c & 2 ? t.y() : 1 - t.y()) * (c & 4 ? t.z() : 1 - t.z());
        }
      }
    }
  }
  std::vector<int> corners;
  for (int k = 0; k + 1 < nodes[2]; ++k) {
    for (int j = 0; j + 1 < nodes[1]; ++j) {
      for (int i = 0; i + 1 < nodes[0]; ++i) {
        for (int t = 0; t < 6; ++t) {
          const int bits[4] = {0, kOrder[t][0], kOrder[t][0] | kOrder[t][1], 7};
          int tet[4];
          for (int c = 0; c < 4; ++c)
            tet[c] = index(i + (bits[c] & 1), j + (bits[c] >> 1 & 1), k + (bits[c] >> 2));
          if (t >= 3) std::swap(tet[2], tet[3]);
          corners.insert(corners.end(), tet, tet + 4);
        }
      }
    }
  }
  input.rest.E =
      Eigen::Map<const Tetrahedra>(corners.data(), static_cast<Eigen::Index>(corners.size() / 4), 4);
  RowMatrixXi vertices(120, 4);
  RowMatrixXd weights(120, 4);
  for (int v = 0; v < 120; ++v) {
    int t = 0, c = 0;
    while (input.rest.E(t, c) != v) (c == 3) ? (c = 0, ++t) : ++c;
    vertices.row(v) = input.rest.E.row(t);
    weights.row(v).setZero();
    weights(v, c) = 1;
  }
  input.contact_points = select_contact_points(input.rest.V, vertices, weights, 3, 80);
}

// The first body of a run, and the step size of its scene.
WorldSettings load_body(BodyInput& input, const std::filesystem::path& out) {
  std::vector<Error> errors;
  const std::string file = (out / "scene.resolved.yaml").string();
  const ConfigNode scene = parse_yaml(read_text_file(file), file, errors);
  if (!errors.empty()) throw errors.front();
  const ConfigNode& body = entry(scene, "bodies").items.at(0);
  input.name = entry(body, "name").scalar;
  input.model = settings(model_schema(), entry(body, "model"));
  input.regularizer = settings(regularizer_schema(), entry(body, "regularizer"));
  input.contact = settings(contact_schema(), entry(body, "contact"));
  input.solver = settings(solver_schema(), entry(body, "solver"));
  input.controller = settings(controller_schema(), entry(body, "controller"));
  const Hdf5Reader mesh(out / "mesh" / (input.name + ".h5"));
  input.rest.V = mesh.matrix("/X0");
  input.rest.E = mesh.int_matrix("/elements");
  input.cage_weights = Hdf5Reader(out / "weights" / (input.name + ".h5")).matrix("/weights");
  const Eigen::VectorXi tet = mesh.int_vector("/embedding/element");
  RowMatrixXi corners(tet.size(), 4);
  for (Eigen::Index i = 0; i < tet.size(); ++i) corners.row(i) = input.rest.E.row(tet[i]);
  input.contact_points =
      select_contact_points(mesh.matrix("/surface/V"), corners, mesh.matrix("/embedding/weights"), 3,
                            static_cast<int>(input.contact["points"].as_integer()));
  const ConfigNode& frames = entry(scene, "frames");
  WorldSettings world;
  world.h = 1 / (std::stod(entry(frames, "fps").scalar) * std::stod(entry(frames, "steps_per_frame").scalar));
  return world;
}

std::vector<Collider> ground(const BodyInput& input) {
  const double y = bounding_box(input.rest.V).min.y();
  TriangleMesh square;
  square.V.resize(4, 3);
  square.V << -50, y, -50, -50, y, 50, 50, y, 50, 50, y, -50;
  square.F.resize(2, 3);
  square.F << 0, 1, 2, 0, 2, 3;
  std::vector<Collider> colliders;
  colliders.emplace_back("ground", square, 1);
  return colliders;
}

struct State {
  Eigen::VectorXd x, v, q;
};

struct Run {
  std::vector<double> step_seconds, iterations;
  std::vector<State> states;
  double seconds = 0;
};

Run run(const BodyInput& input, const WorldSettings& settings, int steps) {
  World world({input}, ground(input), settings);
  Run result;
  for (int step = 0; step < steps; ++step) {
    result.step_seconds.push_back(seconds_of([&] { world.step(); }));
    result.seconds += result.step_seconds.back();
    result.iterations.push_back(world.records().back().iterations);
    const Body& body = world.body(0);
    if (step % kStateInterval == kStateInterval - 1) {
      result.states.push_back({body.x(), body.v(), body.model().rest->basis().transpose() * body.p()});
    }
  }
  return result;
}

// Seconds of the parts of one iteration of the optimiser, on one state.
struct Parts {
  double iteration, factorisation, assembly, regularizer;
};

Parts time_parts(const BodyModel& body, const std::vector<Collider>& colliders, const State& state,
                 double h) {
  StepWorkspace workspace(*body.pattern);
  const std::vector<ContactMemory> memory(static_cast<std::size_t>(body.contact_points.size()));
  const ContactSet contacts(body.contact_points, body.contact, colliders, state.x, 0.1 * body.height, memory);
  std::vector<Goal> wanted;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d direction = Eigen::Vector3d::Unit(axis);
    wanted.push_back({centre_of_mass_weights(body.mass, direction), 0, std::sqrt(body.mass.sum()), 0, 1});
    wanted.push_back({spin_weights(body.mass, state.x, direction), 0, std::sqrt(body.mass.sum()), 0, 0});
  }
  const Goals goals = make_goals(wanted, state.x, h);
  const StepProblem problem(body, contacts, goals, state.x, state.x + h * state.v, state.q, h);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(state.x.size());
  Eigen::MatrixXd rhs(zero.size(), goals.size() + 2);
  rhs << goals.G.transpose(), zero, zero;
  DeformedPoint at = problem.deformed_point(state.x);
  RestPoint rest = problem.rest_point(state.q, true);
  Eigen::MatrixXd sink;

  // One accepted iteration of the SQP: linearise, solve, one trial, derivatives at the new point.
  const auto iteration = [&] {
    const BlockSolver block(problem, at, rest, false, workspace);
    if (!block.definite()) return;
    sink = block.residual() * block.decrement();
    const Eigen::VectorXd dq = block.step_q(0), dx = block.step_x(dq);
    const RestPoint trial_rest = problem.rest_point(rest.q + dq, false);
    const DeformedPoint trial = problem.deformed_point(at.x + dx);
    sink = problem.residual(trial, trial_rest) * problem.objective(trial.x, trial_rest) *
           problem.smallest_element(trial);
    const RestPoint next = problem.rest_point(trial_rest.q, true);
  };
  const auto factorisation = [&] {
    if (workspace.solver.factorize(workspace.D)) sink = workspace.solver.solve(rhs);
  };
  const auto assembly = [&] {
    at = problem.deformed_point(state.x);
    sink = problem.residual(at, rest);
    problem.stiffness(at, rest, workspace.D);
  };
  const auto regularizer = [&] {
    rest = problem.rest_point(state.q, true);
    sink = problem.regularizer_gradient(rest);
    sink = problem.regularizer_gauss_newton(rest);
  };
  std::vector<double> times[4];
  for (int repeat = 0; repeat < kAlternations; ++repeat) {
    times[0].push_back(seconds_of(assembly));
    times[1].push_back(seconds_of(factorisation));
    times[2].push_back(seconds_of(regularizer));
    times[3].push_back(seconds_of(iteration));
  }
  return {median(times[3]), median(times[1]), median(times[0]), median(times[2])};
}

int bench(int argc, char** argv) {
  const double seconds = argc > 2 ? std::atof(argv[2]) : 2;
  BodyInput hopping;
  WorldSettings world;
  if (argc > 1) {
    world = load_body(hopping, argv[1]);
  } else {
    make_box(hopping);
  }
  BodyInput resting = hopping;
  resting.controller = settings(controller_schema(), {});
  const double h = world.h;
  const int steps = std::max(kStateInterval, static_cast<int>(std::lround(seconds / h)));

  std::vector<double> controlled, passive, ratio;
  Run first;
  for (int alternation = 0; alternation < kAlternations; ++alternation) {
    Run hop = run(hopping, world, steps);
    const Run rest = run(resting, world, steps);
    controlled.push_back(hop.seconds / (steps * h));
    passive.push_back(rest.seconds / (steps * h));
    ratio.push_back(mean(hop.step_seconds) / mean(rest.step_seconds));
    if (alternation == 0) first = std::move(hop);
  }

  const BodyModel body = make_body_model(hopping, world);
  const std::vector<Collider> colliders = ground(hopping);
  std::vector<double> iteration, factorisation, assembly, regularizer, over;
  for (const State& state : first.states) {
    const Parts parts = time_parts(body, colliders, state, h);
    iteration.push_back(parts.iteration);
    factorisation.push_back(parts.factorisation);
    assembly.push_back(parts.assembly);
    regularizer.push_back(parts.regularizer);
    over.push_back(parts.iteration / parts.factorisation);
  }
  const double whole = median(iteration);
  const auto share = [&](const std::vector<double>& part) { return 100 * median(part) / whole; };
  const double listed = share(assembly) + share(regularizer) + share(factorisation);

  std::printf("body                              %s\n", argc > 1 ? argv[1] : "box");
  std::printf("degrees of freedom, parameters    %d, %d (%d free)\n", body.dofs(), body.rest->parameters(),
              body.rest->free_parameters());
  std::printf("elements, contact points          %d, %d\n", static_cast<int>(body.mesh.E.rows()),
              body.contact_points.size());
  std::printf("steps of 1/%.0f s                   %d, medians of %d alternations\n", 1 / h, steps,
              kAlternations);
  std::printf("iterations per step, mean         %.2f\n", mean(first.iterations));
  std::printf("iterations per step, p95          %.0f\n", quantile(first.iterations, 0.95));
  std::printf("one iteration                     %.3f ms\n", 1e3 * whole);
  std::printf("  over factorisation of D + %d solves  %.2f\n", 8, median(over));
  std::printf("  share of assembly of c and D    %.0f %%\n", share(assembly));
  std::printf("  share of the rest shape and its regulariser  %.0f %%\n", share(regularizer));
  std::printf("  share of factorisation and solves  %.0f %%\n", share(factorisation));
  std::printf("  share of the remainder          %.0f %%\n", 100 - listed);
  std::printf("controlled over passive step      %.2f\n", median(ratio));
  std::printf("controlled, s per simulated s      %.3f\n", median(controlled));
  std::printf("passive, s per simulated s        %.3f\n", median(passive));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return bench(argc, argv);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.full_text().c_str());
    return exit_code(error.kind());
  }
}
