#include "pipeline/commands.h"

#include <charconv>
#include <cmath>
#include <iostream>
#include <numeric>

#include "common/error.h"
#include "common/file.h"
#include "common/log.h"
#include "common/mesh_io.h"
#include "common/parallel.h"
#include "common/text.h"
#include "pipeline/body_shape.h"
#include "pipeline/diff.h"
#include "pipeline/frame_range.h"
#include "pipeline/pose_file.h"
#include "pipeline/runner.h"
#include "pipeline/scene_file.h"
#include "pipeline/sheet.h"
#include "render/scene.h"

namespace vivify::pipeline {
namespace {

void print_errors(const std::vector<Error>& errors) {
  for (const Error& error : errors) std::cerr << error.full_text() << "\n";
}

void print_warnings(const Scene& scene) {
  for (const Warning& warning : scene_warnings(scene)) {
    std::cerr << warning.where.text() << ": warning: " << warning.text << "\n";
  }
}

// "480x270" as a setting of the scene.
std::string size_override(const std::string& size) {
  int width = 0;
  int height = 0;
  const char* end = size.data() + size.size();
  const auto [cross, width_error] = std::from_chars(size.data(), end, width);
  if (width_error == std::errc() && cross != end && *cross == 'x') {
    const auto [stop, height_error] = std::from_chars(cross + 1, end, height);
    if (height_error == std::errc() && stop == end) {
      return "render.size=[" + std::to_string(width) + ", " + std::to_string(height) + "]";
    }
  }
  throw Error(ErrorKind::usage, "--size " + size + " is not a size", "write it like 480x270");
}

// Later wins: scene file < --quality < --set < the special options.
std::vector<std::string> overrides_of(const SceneCommand& command) {
  std::vector<std::string> overrides;
  if (!command.quality.empty()) overrides = render::quality_overrides(command.quality);
  overrides.insert(overrides.end(), command.set.begin(), command.set.end());
  if (command.spp > 0) overrides.push_back("render.spp=" + std::to_string(command.spp));
  if (!command.size.empty()) overrides.push_back(size_override(command.size));
  return overrides;
}

ProgressStyle progress_style(const SceneCommand& command) {
  if (command.progress == "json") return ProgressStyle::json;
  if (command.progress == "none" || command.quiet) return ProgressStyle::none;
  if (command.progress == "bar") return ProgressStyle::bar;
  return command.progress == "plain" ? ProgressStyle::plain : ProgressStyle::automatic;
}

void print_plan(const Job& job, const RunOptions& options) {
  std::cout << "Output folder: " << job.out.string() << "\n";
  for (const StagePlan& stage : plan(job, options)) {
    std::cout << stage.stage->name << ": ";
    if (stage.missing.empty()) {
      std::cout << "nothing to do (" << stage.products.size() << " files are there)\n";
    } else {
      std::cout << stage.missing.size() << " of " << stage.products.size()
                << " files to make: " << stage.missing.front().file;
      if (stage.missing.size() > 1) std::cout << " ... " << stage.missing.back().file;
      std::cout << "\n";
    }
  }
}

// The body of the scene that a pose file names.
const Value& posed_body(const Scene& scene, const Value& pose) {
  const std::vector<Value>& bodies = scene.settings["bodies"].items();
  const Value& name = pose["body"];
  if (name.is_null()) {
    if (bodies.size() == 1) return bodies.front();
    throw Error(ErrorKind::usage,
                "body is missing: the scene has " + std::to_string(bodies.size()) + " bodies", "",
                pose.where());
  }
  std::vector<std::string> known;
  for (const Value& body : bodies) {
    if (body["name"].as_string() == name.as_string()) return body;
    known.push_back(body["name"].as_string());
  }
  throw Error(ErrorKind::usage, "body = " + name.as_string() + ": there is no such body in the scene",
              known.empty() ? "" : "known: " + join_words(known), name.where());
}

// The triangles with which a simulation mesh is drawn; none for rods.
Triangles surface_triangles(const SimMesh& mesh) {
  if (mesh.element_points() == 4) return boundary_faces({mesh.V, mesh.E});
  return mesh.element_points() == 3 ? Triangles(mesh.E) : Triangles(0, 3);
}

}  // namespace

int run_stages_command(const SceneCommand& command, const std::string& last_stage) {
  if (command.threads > 0) set_thread_count(command.threads);
  std::vector<Error> errors;
  const std::optional<Scene> scene = load_scene(command.scene, overrides_of(command), errors);
  if (!scene) {
    print_errors(errors);
    return exit_code(errors.front().kind());
  }
  print_warnings(*scene);
  Job job{*scene, command.out.empty() ? std::filesystem::path("out") / scene->name : command.out,
          command.frames.empty() ? all_frames(scene->frame_count)
                                 : parse_frames(command.frames, scene->frame_count),
          scene->frame_count};
  // Pictures need the whole simulation (docs/decisions/0003-whole-simulation.md); `simulate` alone may stop
  // earlier.
  if (last_stage == "simulate") job.simulate_to = job.frames.back();
  const RunOptions options = {last_stage, command.force};

  if (command.dry_run) {
    print_plan(job, options);
    return 0;
  }
  const ProgressStyle style = progress_style(command);
  const std::unique_ptr<Progress> progress = make_progress(style);
  run(job, options, *progress);
  if (last_stage == "encode" && style != ProgressStyle::json && !command.quiet) {
    std::cout << (job.out / (scene->name + ".mp4")).string() << "\n";
  }
  return 0;
}

int check_command(const CheckCommand& command) {
  std::vector<Error> errors;
  for (const std::filesystem::path& file : command.scenes) {
    try {
      if (const std::optional<Scene> scene = load_scene(file, command.set, errors)) print_warnings(*scene);
    } catch (const Error& error) {
      errors.push_back(error);
    }
  }
  print_errors(errors);
  return errors.empty() ? 0 : exit_code(errors.front().kind());
}

int schema_command(bool as_markdown) {
  const Schema schema = scene_schema();
  if (as_markdown) {
    std::cout << markdown(schema) << "\n# Pose files\n\n" << markdown(pose_schema());
  } else {
    std::cout << json_schema(schema, "vivify scene");
  }
  return 0;
}

int pose_command(const PoseCommand& command) {
  std::vector<Error> errors;
  const Value pose = load_pose(command.pose, errors);
  if (errors.empty() && !pose.has("scene")) {
    errors.emplace_back(ErrorKind::usage, "scene is missing: it says what body is posed", "", pose.where());
  }
  std::optional<Scene> scene;
  if (errors.empty()) {
    scene = load_scene(command.pose.parent_path() / pose["scene"].as_string(), command.set, errors);
  }
  if (!scene) {
    print_errors(errors);
    return exit_code(errors.front().kind());
  }

  const Value& body = posed_body(*scene, pose);
  const SimMesh rest = make_body_shape(*scene, body).mesh;
  const sim::PoseSolution solution =
      solve_pose(pose, rest, body["model"], scene->settings["gravity"].as_vector3());
  std::filesystem::path output = command.output;
  if (output.empty()) output = std::filesystem::path(command.pose).replace_extension(".ply");
  write_ply(output, {in_asset_coordinates(solution.V, body), surface_triangles(rest), {}, {}, {}});

  const int held = std::accumulate(solution.held.begin(), solution.held.end(), 0);
  log_info(body["name"].as_string() + ": " + std::to_string(solution.held.size()) + " handles hold " +
           std::to_string(held) + " of " + std::to_string(rest.V.rows()) + " vertices; equilibrium after " +
           std::to_string(solution.increments) + " increments and " + std::to_string(solution.iterations) +
           " iterations; the smallest element has " +
           number_text(std::round(1000 * solution.smallest_element) / 1000) + " of its size");
  if (!command.quiet) std::cout << output.string() << "\n";
  return 0;
}

int sheet_command(const SheetCommand& command) {
  SheetSettings settings;
  settings.columns = command.columns;
  settings.frames = command.count;
  settings.width = command.width;
  settings.debug = command.debug;
  settings.exposure_stops = exposure_of(command.folder);
  const std::filesystem::path output = command.output.empty() ? command.folder / "sheet.png" : command.output;
  write_file_atomic(output, contact_sheet(command.folder, settings));
  std::cout << output.string() << "\n";
  return 0;
}

int diff_command(const DiffCommand& command) {
  DiffSettings settings;
  settings.limits.exact = command.exact;
  settings.heat_map = command.heat_map;
  const DiffReport report = diff(command.ref, command.test, settings);
  std::cout << text(report);
  return report.same() ? 0 : 1;
}

}  // namespace vivify::pipeline
