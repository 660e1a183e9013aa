#include "pipeline/scene_file.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <tuple>

#include "common/config.h"
#include "common/file.h"
#include "common/text.h"
#include "pipeline/body_settings.h"
#include "pipeline/collider_settings.h"
#include "pipeline/example_pose.h"
#include "pipeline/friction_settings.h"
#include "pipeline/looks.h"
#include "pipeline/placement.h"
#include "pipeline/pose_file.h"
#include "render/lens.h"
#include "render/lights/light.h"
#include "render/scene.h"
#include "sim/control/behavior.h"
#include "sim/control/controllers/goals.h"
#include "sim/control/controllers/pose.h"
#include "sim/control/controllers/turn.h"
#include "sim/control/course.h"
#include "sim/elastic/models.h"

namespace vivify::pipeline {
namespace {

constexpr double kMostFrames = 1'000'000;

Schema video_schema() {
  return object("The video made of the pictures.")
      .field("crf",
             integer("Quality of H.264: 0 is lossless, 51 the worst.").at_least(0).at_most(51).initially(18))
      .field("exposure_stops", number("The light is multiplied by 2 to this power before the view transform.")
                                   .at_least(-20)
                                   .at_most(20)
                                   .initially(0.0));
}

Schema frames_schema() {
  return object("Length and time steps of the video. Frame 1 is t = 0.")
      .field("fps", integer("Frames per second.").unit("1/s").at_least(1).at_most(1000).initially(24))
      .field("duration_s", number("Length of the video.").unit("s").above(0).initially(4.0))
      .field("steps_per_frame",
             integer("Simulation steps per frame; the time step is 1/(fps steps_per_frame).")
                 .at_least(1)
                 .at_most(10000)
                 .initially(2));
}

// The camera of the renderer with the keys that this module adds.
Schema following_camera_schema() {
  return render::camera_schema()
      .field("follow_smooth_s",
             number("Width of the window that smooths the path of the followed body; 0 follows it "
                    "rigidly.")
                 .unit("s")
                 .at_least(0)
                 .initially(1.0))
      .field("follow_height", boolean("Whether the camera also follows up and down.").initially(false));
}

// Calls visit(schema, value, path) for every setting below a value.
using Visitor = std::function<void(const Schema&, const Value&, const std::string&)>;
void walk(const Schema& schema, const Value& value, const std::string& name, const Visitor& visit) {
  visit(schema, value, name);
  const auto below = [&](const std::string& key) { return name.empty() ? key : name + "." + key; };
  switch (schema.kind) {
    case Schema::Kind::object:
      if (value.kind() != Value::Kind::map) return;
      for (const auto& [key, field] : schema.fields) walk(field, value[key], below(key), visit);
      return;
    case Schema::Kind::variant:
      if (value.kind() != Value::Kind::map) return;
      for (const auto& [option, fields] : schema.options) {
        if (schema.tag.empty()) {
          walk(fields, value[option], below(option), visit);
        } else if (value[schema.tag].as_string() == option) {
          walk(fields, value, name, visit);
        }
      }
      return;
    case Schema::Kind::list:
      if (value.kind() != Value::Kind::list) return;
      for (std::size_t i = 0; i < value.items().size(); ++i) {
        walk(*schema.item, value.items()[i], name + "[" + std::to_string(i) + "]", visit);
      }
      return;
    case Schema::Kind::dictionary:
      if (value.kind() != Value::Kind::map) return;
      for (const auto& [key, item] : value.entries()) walk(*schema.item, item, below(key), visit);
      return;
    default:
      return;
  }
}

// Checks what ties settings to one another and to files.
class SemanticCheck {
 public:
  SemanticCheck(const Scene& scene, std::vector<Error>& errors) : scene_(scene), errors_(errors) {}

  // Files can be looked for beside settings that are wrong.
  void files(const Schema& schema) {
    walk(schema, scene_.settings, "",
         [&](const Schema& setting, const Value& value, const std::string& name) {
           if (setting.kind == Schema::Kind::path && !value.is_null()) file_exists(value, name);
         });
  }

  // What ties settings to one another; needs all of them.
  void references() {
    names();
    looks();
    asset_looks();
    bodies();
    colliders();
    check_friction(scene_.settings, errors_);
    camera();
    frames();
    picture();
  }

 private:
  void fail(const Value& value, const std::string& message, const std::string& hint = {}) {
    errors_.emplace_back(ErrorKind::usage, message, hint, value.where());
  }

  void file_exists(const Value& value, const std::string& name) {
    const std::filesystem::path path = scene_.resolve_path(value.as_string());
    std::error_code error;
    if (std::filesystem::is_regular_file(path, error)) return;
    fail(value, name + " = " + value.as_string() + ": there is no file " + path.lexically_normal().string(),
         "paths are relative to the scene file");
  }

  void names() {
    std::map<std::string, std::string> seen;
    each_placed([&](const Value& item, const std::string& where) {
      const Value& name = item["name"];
      const std::string& text = name.as_string();
      const bool plain = !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
        return (c < 128 && std::isalnum(c) != 0) || c == '-' || c == '_';
      });
      if (!plain) {
        fail(name, where + ".name = '" + text + "' must be made of letters, digits, '-' and '_'",
             "it names files");
      }
      const auto [entry, fresh] = seen.emplace(text, where);
      if (!fresh && entry->second.substr(0, entry->second.find('[')) != where.substr(0, where.find('['))) {
        fail(name, where + ".name = '" + text + "' is the name of " + entry->second + " already");
      }
    });
  }

  void looks() {
    std::vector<std::string> materials;
    for (const auto& [name, material] : scene_.settings["materials"].entries()) materials.push_back(name);
    each_placed([&](const Value& item, const std::string& where) {
      for (const auto& [part, material] : item["looks"].entries()) {
        if (std::find(materials.begin(), materials.end(), material.as_string()) != materials.end()) continue;
        fail(material,
             where + ".looks." + part + " = " + material.as_string() + ": there is no such material",
             suggestion(material.as_string(), materials));
      }
    });
  }

  // Read here, because their faults shall not come out after hours of simulation.
  void asset_looks() {
    each_placed([&](const Value& item, const std::string&) {
      std::error_code ignored;
      if (!item.has("mesh") ||
          !std::filesystem::is_regular_file(scene_.resolve_path(item["mesh"].as_string()), ignored)) {
        return;
      }
      attempt(item["mesh"], [&] { check_asset_looks(scene_, item); });
    });
  }

  void bodies() {
    const std::vector<Value>& bodies = scene_.settings["bodies"].items();
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const std::string where = "bodies[" + std::to_string(i) + "]";
      check_body(bodies[i], where, errors_);
      for (const char* outside : {"handles", "pushes"}) {
        const Value& forces = bodies[i][outside];
        if (forces.items().empty() || scene_.settings["physics"].as_string() != "static") continue;
        fail(forces, where + "." + outside + " does not fit: physics = static has no forces from outside",
             "make the physics dynamic, or give poses");
      }
      std::vector<std::string> examples;
      for (const Value& example : examples_of(bodies[i])) examples.push_back(example_name(example));
      for (const auto& [part, settings] : behaviors_of(bodies[i])) {
        const bool planar = is_planar(body_kind(bodies[i]));
        sim::check_course(settings, where + "." + part, planar, errors_);
        sim::check_turn(settings, where + "." + part, planar, errors_);
        sim::check_goals(settings, where + "." + part, errors_);
        sim::check_example(settings, where + "." + part, examples, errors_);
        attempt(settings, [&] {
          for (const auto& [key, other] : sim::looked_at(settings)) {
            const std::string who = where + "." + part + "." + key;
            body_exists(other, who);
            if (other.as_string() == bodies[i]["name"].as_string())
              fail(other, who + " = " + other.as_string() + " is the body itself", "name another body");
          }
        });
      }
      for (const Value& example : examples_of(bodies[i])) {
        const std::filesystem::path pose =
            example.has("pose") ? scene_.resolve_path(example["pose"].as_string()) : "";
        if (std::filesystem::is_regular_file(pose)) load_pose(pose, errors_);
      }
    }
  }

  // Meshes of colliders are read here: their faults shall not come out after hours of simulation.
  void colliders() {
    const std::vector<Value>& colliders = scene_.settings["colliders"].items();
    for (std::size_t i = 0; i < colliders.size(); ++i) {
      const std::string where = "colliders[" + std::to_string(i) + "]";
      const std::size_t before = errors_.size();
      check_collider(colliders[i], where, errors_);
      const bool readable =
          !colliders[i].has("mesh") ||
          std::filesystem::is_regular_file(scene_.resolve_path(colliders[i]["mesh"].as_string()));
      if (errors_.size() == before && readable) {
        attempt(colliders[i], [&] { make_collider(scene_, colliders[i], where); });
      }
    }
  }

  void body_exists(const Value& name, const std::string& who) {
    std::vector<std::string> bodies;
    for (const Value& body : scene_.settings["bodies"].items()) bodies.push_back(body["name"].as_string());
    if (std::find(bodies.begin(), bodies.end(), name.as_string()) != bodies.end()) return;
    fail(name, who + " = " + name.as_string() + ": there is no such body",
         suggestion(name.as_string(), bodies));
  }

  void camera() {
    const Value& follow = scene_.settings["camera"]["follow"];
    if (!follow.is_null()) body_exists(follow, "camera.follow");
  }

  void frames() {
    const Value& frames = scene_.settings["frames"];
    const double count = frames["duration_s"].as_number() * frames["fps"].as_number();
    if (!(std::round(count) >= 1)) {
      fail(frames["duration_s"], "frames.duration_s = " + number_text(frames["duration_s"].as_number()) +
                                     " s is shorter than one frame");
    } else if (count > kMostFrames) {
      fail(frames["duration_s"], "frames.duration_s = " + number_text(frames["duration_s"].as_number()) +
                                     " s makes more than a million frames");
    }
  }

  // What the renderer would say of camera and lights, before anything is simulated. Lights with a file are
  // left out: images are read when they are needed.
  void picture() {
    const Value& camera = scene_.settings["camera"];
    attempt(camera, [&] {
      const render::RenderSettings settings = render::make_settings(scene_.settings["render"]);
      render::Lens(render::make_camera(camera), settings.width, settings.height);
    });
    for (const Value& light : scene_.settings["lights"].items()) {
      if (!light.has("file")) attempt(light, [&] { render::make_light(light, scene_.folder); });
    }
  }

  void attempt(const Value& value, const std::function<void()>& make) {
    try {
      make();
    } catch (const Error& error) {
      const bool placed = !error.where().file.empty();
      errors_.emplace_back(error.kind(), error.what(), error.hint(), placed ? error.where() : value.where());
    }
  }

  static std::string suggestion(const std::string& word, const std::vector<std::string>& known) {
    const std::string nearest = nearest_word(word, known);
    if (!nearest.empty()) return "did you mean '" + nearest + "'?";
    return known.empty() ? "" : "known: " + join_words(known);
  }

  void each_placed(const std::function<void(const Value&, const std::string&)>& visit) {
    for (const char* list : {"bodies", "colliders", "props"}) {
      const Value& items = scene_.settings[list];
      for (std::size_t i = 0; i < items.items().size(); ++i) {
        visit(items.items()[i], std::string(list) + "[" + std::to_string(i) + "]");
      }
    }
  }

  const Scene& scene_;
  std::vector<Error>& errors_;
};

}  // namespace

Schema scene_schema() {
  return object("A vivify scene.")
      .field("version", integer("Version of the scene format.").at_least(1).at_most(1).required())
      .field("frames", frames_schema())
      .field("gravity", vector("Acceleration of gravity.", 3).unit("m/s²").initially({0, -9.81, 0}))
      .field("physics",
             choice("What a step is. `dynamic`: motion with inertia, gravity and contact. `static`: the "
                    "equilibrium of each body for its rest shape of that time, without any of them.",
                    {"dynamic", "static"})
                 .initially("dynamic"))
      .field("materials", dictionary("Looks, by name.", render::material_schema()))
      .field("bodies", list("Soft characters and objects; they are simulated.", body_schema()))
      .field("colliders", list("Objects that bodies touch.", collider_schema()))
      .field("friction", friction_schema())
      .field("props",
             list("Objects that are drawn only.", placed_schema("A fixed object that is drawn only.", true)))
      .field("camera", following_camera_schema())
      .field("lights", list("Lights. Without any, a uniform white environment.", render::light_schema()))
      .field("render", render::render_schema())
      .field("video", video_schema());
}

std::filesystem::path Scene::resolve_path(const std::string& path) const { return folder / path; }

std::vector<Warning> scene_warnings(const Scene& scene) {
  std::vector<Warning> warnings;
  const std::vector<Value>& bodies = scene.settings["bodies"].items();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (const std::string& text : sim::model_warnings(bodies[i]["model"])) {
      warnings.push_back({bodies[i]["model"].where(), "bodies[" + std::to_string(i) + "]." + text});
    }
    const double spawn = bodies[i]["spawn_s"].as_number(), last = (scene.frame_count - 1.0) / scene.fps;
    if (spawn > last) {
      warnings.push_back(
          {bodies[i]["spawn_s"].where(), "bodies[" + std::to_string(i) + "].spawn_s = " + number_text(spawn) +
                                             " s is after the last frame, at " + number_text(last) +
                                             " s: the body never appears"});
    }
  }
  return warnings;
}

std::optional<Scene> load_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides,
                                std::vector<Error>& errors) {
  const std::size_t errors_before = errors.size();
  ConfigNode root = parse_yaml(read_text_file(file), file.string(), errors);
  const bool is_no_yaml = root.kind == ConfigNode::Kind::null && errors.size() > errors_before;
  if (is_no_yaml) return std::nullopt;
  for (const std::string& assignment : overrides) {
    try {
      apply_override(root, assignment);
    } catch (const Error& error) {
      errors.push_back(error);
    }
  }

  const Schema schema = scene_schema();
  Scene scene;
  scene.file = file;
  scene.folder = file.parent_path();
  scene.name = file.stem().string();
  scene.settings = resolve(schema, root, errors);
  SemanticCheck check(scene, errors);
  const bool settings_are_whole = errors.size() == errors_before;
  check.files(schema);
  if (settings_are_whole) check.references();
  if (errors.size() > errors_before) {
    std::stable_sort(errors.begin() + static_cast<std::ptrdiff_t>(errors_before), errors.end(),
                     [](const Error& a, const Error& b) {
                       return std::tuple(a.where().line, a.where().column) <
                              std::tuple(b.where().line, b.where().column);
                     });
    return std::nullopt;
  }

  const Value& frames = scene.settings["frames"];
  scene.fps = static_cast<int>(frames["fps"].as_integer());
  scene.steps_per_frame = static_cast<int>(frames["steps_per_frame"].as_integer());
  scene.frame_count = static_cast<int>(std::lround(frames["duration_s"].as_number() * scene.fps));
  scene.resolved = scene.settings.yaml();
  return scene;
}

}  // namespace vivify::pipeline
