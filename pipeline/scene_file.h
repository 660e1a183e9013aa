// The scene file: its schema, put together from the schemas of the modules, and a scene that was read and
// checked.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/error.h"
#include "common/schema.h"
#include "common/value.h"

namespace vivify::pipeline {

// The schema of a whole scene file.
Schema scene_schema();

struct Scene {
  std::filesystem::path file;    // as given
  std::filesystem::path folder;  // paths in the scene start here
  std::string name;              // file name without ending; names the results
  Value settings;                // everything, with defaults
  std::string resolved;          // settings as YAML: scene.resolved.yaml
  int frame_count = 0;           // frames 1 … frame_count; frame 1 is t = 0
  int fps = 24;
  int steps_per_frame = 1;

  // Time step h (s).
  double time_step() const { return 1.0 / (static_cast<double>(fps) * steps_per_frame); }
  // A path of the scene, made relative to the working folder.
  std::filesystem::path resolve_path(const std::string& path) const;
};

// Reads a scene file, applies `overrides` ("path.to.key=value", later ones win), fills in defaults and checks
// everything that can be seen without reading other files, and that those files exist. Adds one Error(usage)
// per problem to `errors` and gives a scene only when there is none. Throws Error(io) when the file cannot be
// read.
std::optional<Scene> load_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides,
                                std::vector<Error>& errors);

// Something in a scene that is legal but seldom meant.
struct Warning {
  Location where;
  std::string text;
};
std::vector<Warning> scene_warnings(const Scene& scene);

}  // namespace vivify::pipeline
