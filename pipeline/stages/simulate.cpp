// simulate: one file per frame with the state of every body, and the tables gathered from them.
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

#include "common/error.h"
#include "common/hdf5_file.h"
#include "common/log.h"
#include "common/stop.h"
#include "meshing/skin.h"
#include "pipeline/arrival.h"
#include "pipeline/body_settings.h"
#include "pipeline/collider_settings.h"
#include "pipeline/content_key.h"
#include "pipeline/frame_range.h"
#include "pipeline/friction_settings.h"
#include "pipeline/handle_settings.h"
#include "pipeline/push_settings.h"
#include "pipeline/run_report.h"
#include "pipeline/stages/stages.h"
#include "pipeline/step_table.h"
#include "sim/contact/contact_points.h"
#include "sim/step_record.h"
#include "sim/world.h"

namespace vivify::pipeline {
namespace {

constexpr const char* kStepsFile = "sim/steps.csv";
constexpr const char* kSummaryFile = "sim/summary.json";

std::vector<Product> products(const Job& job) {
  const std::string key = simulation_key(job);
  std::vector<Product> products;
  for (int frame = 1; frame <= job.simulate_to; ++frame) products.push_back({simulation_file(frame), key});
  const std::string tables = Hasher().add(key).add(std::to_string(job.simulate_to)).hex();
  products.push_back({kStepsFile, tables});
  products.push_back({kSummaryFile, tables});
  return products;
}

// Points in elements of the mesh, with weights of their corners (#P by k).
sim::ContactPoints embedded_points(const SimMesh& rest, const Eigen::VectorXi& element,
                                   const RowMatrixXd& weights) {
  sim::ContactPoints points;
  points.dimension = rest.dimension();
  points.vertices.resize(element.size(), rest.element_points());
  for (Eigen::Index i = 0; i < element.size(); ++i) points.vertices.row(i) = rest.E.row(element[i]);
  points.weights = weights;
  return points;
}

// Points of the drawn surface, or of the rod or shell itself: vertices and middles of edges. Bodies of the
// plane touch with their points of z = 0.
sim::ContactPoints load_contact_points(const Value& body, const SimMesh& rest, const Hdf5Reader& mesh) {
  const auto count = static_cast<int>(body["contact"]["points"].as_integer());
  const int d = rest.dimension();
  meshing::Embedding embedding;
  Points surface;
  const BodyKind kind = body_kind(body);
  if (kind == BodyKind::rod || kind == BodyKind::shell) {
    embedding = meshing::embed_edges(rest.E);
    surface = Points::Zero(embedding.element.size(), 3);
    surface.leftCols(d) = meshing::interpolate(embedding, rest.E, rest.V);
  } else {
    embedding = {mesh.int_vector("/embedding/element"), mesh.matrix("/embedding/weights")};
    surface = mesh.matrix("/surface/V");
    if (kind == BodyKind::flat) surface.col(2).setZero();
  }
  const sim::ContactPoints points = embedded_points(rest, embedding.element, embedding.weights);
  return sim::select_contact_points(surface, points.vertices, points.weights, d, count);
}

// The surface with which a solid touches other bodies; none for the others, which touch with their mesh.
std::optional<sim::ContactSurface> load_contact_surface(const SimMesh& rest, const Hdf5Reader& mesh) {
  if (!mesh.has("/contact")) return std::nullopt;
  sim::ContactSurface surface;
  const RowMatrixXd V = mesh.matrix("/contact/V");
  surface.rest = Points::Zero(V.rows(), 3);
  surface.rest.leftCols(V.cols()) = V;
  if (V.cols() == 2) {
    surface.edges = mesh.int_matrix("/contact/F");
  } else {
    surface.faces = mesh.int_matrix("/contact/F");
    surface.edges = sim::edges_of(surface.faces);
  }
  surface.points =
      embedded_points(rest, mesh.int_vector("/contact/element"), mesh.matrix("/contact/weights"));
  return surface;
}

sim::World make_world(const Job& job) {
  const Scene& scene = job.scene;
  std::vector<sim::BodyInput> bodies;
  const std::vector<Value>& characters = scene.settings["bodies"].items();
  for (std::size_t i = 0; i < characters.size(); ++i) {
    bodies.push_back(simulated_body(job.out, characters[i]));
    bodies.back().spawn = characters[i]["spawn_s"].as_number();
    bodies.back().handles = make_handles(characters[i], "bodies[" + std::to_string(i) + "]");
    bodies.back().pushes = make_pushes(characters[i]);
    bodies.back().friction_with = friction_of(scene.settings, bodies.back().name);
  }
  std::vector<sim::Collider> colliders;
  const std::vector<Value>& items = scene.settings["colliders"].items();
  for (std::size_t i = 0; i < items.size(); ++i) {
    colliders.push_back(make_collider(scene, items[i], "colliders[" + std::to_string(i) + "]"));
  }
  return sim::World(bodies, std::move(colliders),
                    {scene.settings["gravity"].as_vector3(), scene.time_step(),
                     scene.settings["physics"].as_string() == "static"});
}

// Files of an earlier, different simulation would look like frames of this one.
void remove_stale_frames(const Job& job, Ledger& ledger, const std::string& key) {
  for (const std::string& file : ledger.files()) {
    if (!file.starts_with("sim/frames/") || ledger.key(file) == key) continue;
    std::error_code ignored;
    std::filesystem::remove(job.out / file, ignored);
    ledger.forget(file);
  }
}

double mean(const std::vector<double>& values) {
  return values.empty()
             ? 0
             : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}
double largest(const std::vector<double>& values) {
  return values.empty() ? 0 : *std::max_element(values.begin(), values.end());
}
double smallest(const std::vector<double>& values) {
  return values.empty() ? 1 : *std::min_element(values.begin(), values.end());
}
// The smallest value that `share` of the values do not exceed.
double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const double rank = std::ceil(share * static_cast<double>(values.size()));
  return values[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

std::string gather_steps(const Job& job) {
  std::string csv = sim::csv_header();
  for (int frame = 1; frame <= job.simulate_to; ++frame) {
    csv += Hdf5Reader(job.out / simulation_file(frame)).text("/steps");
  }
  return csv;
}

std::string summarize(const Job& job, const std::string& csv) {
  const StepTable steps(csv);
  nlohmann::ordered_json summary;
  summary["frames"] = job.simulate_to;
  summary["h_s"] = job.scene.time_step();
  summary["bodies"] = nlohmann::ordered_json::object();
  for (const Value& body : job.scene.settings["bodies"].items()) {
    const std::string& name = body["name"].as_string();
    const Hdf5Reader last(job.out / simulation_file(job.simulate_to));
    if (!last.has("/bodies/" + name + "/x")) continue;  // it has not appeared yet
    const std::vector<double> iterations = steps.column("sqp_iterations", name);
    const std::vector<double> fallback = steps.column("fallback", name);
    summary["bodies"][name] = {
        {"model", body["model"]["type"].as_string()},
        {"space", body["rest_space"]["type"].as_string()},
        {"dofs", last.matrix("/bodies/" + name + "/x").size()},
        {"params", last.vector("/bodies/" + name + "/p").size()},
        {"steps", iterations.size()},
        {"sqp_iterations_mean", mean(iterations)},
        {"sqp_iterations_p95", percentile(iterations, 0.95)},
        {"fallback_steps", std::count_if(fallback.begin(), fallback.end(), [](double f) { return f != 0; })},
        {"max_residual_rel", largest(steps.column("residual_rel", name))},
        {"max_p_rate", largest(steps.column("p_rate", name))},
        {"max_rest_rate_per_s", largest(steps.column("rest_rate_per_s", name))},
        {"min_rest_element_ratio", smallest(steps.column("min_rest_element_ratio", name))},
        {"min_rest_volume_ratio", smallest(steps.column("rest_volume_ratio", name))},
        {"max_rest_volume_ratio", largest(steps.column("rest_volume_ratio", name))}};
    bool told = false;
    if (const std::optional<Destination> goal = destination(body)) {
      const RowMatrixXd rest = Hdf5Reader(job.out / mesh_file(body)).matrix("/X0");
      const double gravity = job.scene.settings["gravity"].as_vector3().norm();
      const Arrival arrival =
          judge_arrival(body, *goal, steps, gravity, rest, last.matrix("/bodies/" + name + "/x"));
      summary["bodies"][name]["arrival"] = {{"place", {goal->place.x(), goal->place.y(), goal->place.z()}},
                                            {"arrived", arrival.arrived},
                                            {"missing_m", arrival.missing},
                                            {"reasons", arrival.reasons}};
      told = !arrival.arrived;
      if (told) log_warning(describe(name, arrival));
    }
    const Progression reached = progression(body, steps);
    summary["bodies"][name]["never_began"] = reached.never_began;
    if (!told && !reached.never_began.empty()) log_warning(describe(name, reached));
  }
  return summary.dump(2) + "\n";
}

void make(const Job& job, const std::vector<Product>& missing, Ledger& ledger, Progress& progress) {
  const auto is_missing = [&](const std::string& file) {
    return std::any_of(missing.begin(), missing.end(),
                       [&](const Product& product) { return product.file == file; });
  };
  const std::string key = simulation_key(job);
  remove_stale_frames(job, ledger, key);

  std::unique_ptr<sim::World> world;
  std::map<std::string, BodyTiming> timing;
  const auto note_timing = [&](bool afresh) {
    if (!world || world->body_count() == 0) return;
    for (int i = 0; i < world->body_count(); ++i) {
      timing[world->body(i).model().name].wall_seconds = world->body(i).wall_seconds();
    }
    update_body_timing(job.out, timing, afresh);
  };
  const bool afresh = is_missing(simulation_file(1));
  try {
    int reached = 0;  // frame that the world stands at
    for (int frame = 1; frame <= job.simulate_to; ++frame) {
      if (!is_missing(simulation_file(frame))) continue;
      if (!world) world = std::make_unique<sim::World>(make_world(job));
      if (frame > 1) {
        if (reached != frame - 1) world->restore(Hdf5Reader(job.out / simulation_file(frame - 1)));
        for (int step = 0; step < job.scene.steps_per_frame; ++step) {
          check_stop();
          world->step();
        }
        for (int i = 0; i < world->body_count(); ++i) {
          if (!world->present(i)) continue;
          timing[world->body(i).model().name].sim_seconds +=
              job.scene.time_step() * job.scene.steps_per_frame;
        }
      }
      Hdf5Writer file;
      world->save(file);
      ledger.commit(simulation_file(frame), key, file.image());
      reached = frame;
      progress.advance(1, "frame " + std::to_string(frame));
    }
  } catch (...) {
    note_timing(afresh);
    throw;
  }
  note_timing(afresh);

  const std::string csv = gather_steps(job);
  for (const Product& product : missing) {
    if (product.file == kStepsFile) {
      ledger.commit(product.file, product.key, std::as_bytes(std::span(csv)));
      progress.advance(1);
    } else if (product.file == kSummaryFile) {
      const std::string summary = summarize(job, csv);
      ledger.commit(product.file, product.key, std::as_bytes(std::span(summary)));
      progress.advance(1);
    }
  }
}

}  // namespace

sim::BodyInput simulated_body(const std::filesystem::path& out, const Value& body) {
  const Hdf5Reader mesh(out / mesh_file(body)), weights(out / weights_file(body));
  sim::BodyInput input;
  input.name = body["name"].as_string();
  input.rest = {mesh.matrix("/X0"), mesh.int_matrix("/elements")};
  input.rest_space = body["rest_space"]["type"].as_string();
  if (weights.has("/weights")) input.cage_weights = weights.matrix("/weights");
  if (weights.has("/examples")) {
    const std::vector<std::string> names = weights.texts("/examples/names");
    const std::vector<std::string> groups = weights.texts("/examples/groups");
    for (std::size_t i = 0; i < names.size(); ++i) {
      input.examples.push_back(
          {names[i], groups[i], weights.matrix("/examples/" + std::to_string(i) + "/V")});
    }
  }
  input.contact_points = load_contact_points(body, input.rest, mesh);
  input.model = body["model"];
  input.regularizer = body["regularizer"];
  input.contact = body["contact"];
  input.controller = body["controller"];
  input.behavior = body["behavior"];
  input.solver = body["solver"];
  input.surface = load_contact_surface(input.rest, mesh);
  input.velocity = body["velocity"].as_vector3();
  input.where = body["position"].where();
  return input;
}

std::string simulation_key(const Job& job) {
  const Scene& scene = job.scene;
  ContentKey key("sim");
  key.add("fps", scene.fps)
      .add("steps_per_frame", scene.steps_per_frame)
      .add("gravity", scene.settings["gravity"])
      .add("physics", scene.settings["physics"])
      .add("friction", scene.settings["friction"]);
  for (const Value& body : scene.settings["bodies"].items()) {
    key.add("weights", weights_key(job, body));
    for (const char* part : {"name", "model", "regularizer", "contact", "controller", "behavior", "solver",
                             "velocity", "handles", "pushes", "spawn_s"}) {
      key.add(part, body[part]);
    }
  }
  for (const Value& collider : scene.settings["colliders"].items()) {
    for (const char* part : {"name", "friction", "surface_velocity"}) key.add(part, collider[part]);
    add_collider_geometry(key, scene, collider);
  }
  return key.hex();
}

std::string simulation_file(int frame) { return "sim/frames/" + frame_text(frame) + ".h5"; }

Stage simulate_stage() { return {"simulate", "Everything up to the simulation", products, make}; }

}  // namespace vivify::pipeline
