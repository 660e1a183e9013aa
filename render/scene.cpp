#include "render/scene.h"

#include <utility>

#include "common/error.h"
#include "common/text.h"

namespace vivify::render {

Schema camera_schema() {
  return object("The camera, a thin lens.")
      .field("position", vector("Where it stands.", 3).unit("m").initially({0, 1.5, 6}))
      .field("target", vector("The point in the middle of the picture.", 3).unit("m").initially({0, 0.5, 0}))
      .field("up", vector("The direction that is up in the picture.", 3).initially({0, 1, 0}))
      .field("follow", string("Name of a body; the camera goes along with it."))
      .field("fov_deg", number("Vertical angle of view.").unit("°").above(0).below(179).initially(35))
      .field("aperture_radius_m",
             number("Radius of the lens; 0 draws everything sharp.").unit("m").at_least(0).initially(0))
      .field("focus_m", number("Distance in focus along the view; 0 is the distance of the target.")
                            .unit("m")
                            .at_least(0)
                            .initially(0));
}

Camera make_camera(const Value& value) {
  Camera camera;
  camera.position = value["position"].as_vector3();
  camera.target = value["target"].as_vector3();
  camera.up = value["up"].as_vector3();
  camera.fov_deg = value["fov_deg"].as_number();
  camera.aperture_radius_m = value["aperture_radius_m"].as_number();
  camera.focus_m = value["focus_m"].as_number();
  return camera;
}

Schema render_schema() {
  const QualityPreset& preset = quality_presets()[1];
  return object("Size and quality of the pictures.")
      .field("size", vector("Width and height.", 2)
                         .unit("pixels")
                         .at_least(1)
                         .at_most(16384)
                         .initially({static_cast<double>(preset.width), static_cast<double>(preset.height)}))
      .field("spp", integer("Samples per pixel; powers of two are best.")
                        .at_least(1)
                        .at_most(1 << 20)
                        .initially(preset.spp))
      .field("splits",
             integer("Paths that go on from the first rough surface of each sample. More make soft light and "
                     "reflections smoother without more samples at the edges.")
                 .at_least(1)
                 .at_most(64)
                 .initially(preset.splits))
      .field("max_depth", integer("Most surfaces that a path of light is scattered at.")
                              .at_least(1)
                              .at_most(1000)
                              .initially(6))
      .field(
          "indirect_roughness",
          number(
              "Least roughness of surfaces that light meets on its way to a matt one; 0 changes nothing. It "
              "spreads out the bright specks that polished things throw on matt ones, without losing their "
              "light.")
              .at_least(0)
              .at_most(1)
              .initially(0))
      .field("seed", integer("Another seed gives other noise.").at_least(0).initially(0))
      .field(
          "clamp",
          number(
              "Largest luminance that one path of indirect light may add; 0 is no limit. A limit takes out "
              "bright specks and makes the picture a little too dark.")
              .unit("W/(m² sr)")
              .at_least(0)
              .initially(0));
}

RenderSettings make_settings(const Value& value) {
  RenderSettings settings;
  const Eigen::VectorXd size = value["size"].as_vector();
  if (size[0] != std::floor(size[0]) || size[1] != std::floor(size[1])) {
    throw Error(ErrorKind::usage, "render.size must be whole numbers of pixels", "", value["size"].where());
  }
  settings.width = static_cast<int>(size[0]);
  settings.height = static_cast<int>(size[1]);
  settings.spp = static_cast<int>(value["spp"].as_integer());
  settings.splits = static_cast<int>(value["splits"].as_integer());
  settings.max_depth = static_cast<int>(value["max_depth"].as_integer());
  settings.seed = static_cast<std::uint64_t>(value["seed"].as_integer());
  settings.indirect_roughness = value["indirect_roughness"].as_number();
  settings.clamp = value["clamp"].as_number();
  return settings;
}

const std::vector<QualityPreset>& quality_presets() {
  static const std::vector<QualityPreset> presets = {
      {"draft", 320, 180, 4, 2}, {"preview", 480, 270, 8, 4}, {"final", 1280, 720, 64, 1}};
  return presets;
}

std::vector<std::string> quality_overrides(const std::string& name) {
  std::vector<std::string> names;
  for (const QualityPreset& preset : quality_presets()) {
    if (preset.name == name) {
      return {"render.size=[" + std::to_string(preset.width) + ", " + std::to_string(preset.height) + "]",
              "render.spp=" + std::to_string(preset.spp), "render.splits=" + std::to_string(preset.splits)};
    }
    names.push_back(preset.name);
  }
  throw Error(ErrorKind::usage, "no quality is called '" + name + "'", "it is " + join_words(names, "or"));
}

namespace {

// The string settings `file` anywhere below a value.
void collect_files(const Value& value, const std::filesystem::path& folder,
                   std::vector<std::filesystem::path>& files) {
  if (value.kind() == Value::Kind::list) {
    for (const Value& item : value.items()) collect_files(item, folder, files);
  } else if (value.kind() == Value::Kind::map) {
    for (const auto& [key, entry] : value.entries()) {
      if (key == "file" && entry.kind() == Value::Kind::string)
        files.push_back(folder / entry.as_string());
      else
        collect_files(entry, folder, files);
    }
  }
}

}  // namespace

std::vector<std::filesystem::path> referenced_files(const Looks& looks) {
  std::vector<std::filesystem::path> files;
  for (const auto& [name, material] : looks.materials) collect_files(material, looks.folder, files);
  for (const Value& light : looks.lights) collect_files(light, looks.folder, files);
  return files;
}

}  // namespace vivify::render
