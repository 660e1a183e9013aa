#include "pipeline/looks.h"

#include <algorithm>
#include <utility>

#include "common/config.h"
#include "common/error.h"
#include "common/gltf_file.h"
#include "common/text.h"
#include "render/materials/microfacet.h"

namespace vivify::pipeline {
namespace {

// Names of materials that a scene cannot refer to: the grey, and that of a part in an asset file.
constexpr const char* kDefaultMaterial = "(default)";
std::string own_material(const Value& item, const std::string& part) {
  return "(" + item["mesh"].as_string() + ": " + part + ")";
}

// A setting that the scene does not give, from its YAML text.
Value built_in(const Schema& schema, const std::string& yaml) {
  std::vector<Error> errors;
  const ConfigNode node = parse_yaml(yaml, "built-in", errors);
  Value value = errors.empty() ? resolve(schema, node, errors) : Value();
  if (!errors.empty()) throw Error(ErrorKind::internal, errors.front().full_text());
  return value;
}

// What the file of an object's mesh says of the parts that `looks` leaves out.
std::vector<PartLook> own_looks(const Scene& scene, const Value& item) {
  const Value& given = item["looks"];
  if (!item.has("mesh") || given.has("all")) return {};
  std::vector<PartLook> looks = read_part_looks(scene.resolve_path(item["mesh"].as_string()));
  std::erase_if(looks, [&](const PartLook& look) { return given.has(look.part); });
  return looks;
}

// The material of the part of an asset; `mesh` is the file as the scene names it.
Value make_material(const PartLook& look, const std::filesystem::path& mesh) {
  Value material = Value::map();
  material.set("type", Value::string(look.metallic >= 0.5 ? "metal" : "porcelain"));
  std::vector<Value> color;
  for (const double channel : look.color) color.push_back(Value::number(channel));
  material.set("color", Value::list(std::move(color)));
  material.set("roughness", Value::number(std::max(look.roughness, render::kMirrorRoughness)));
  if (look.texture || look.embedded_texture) {
    Value texture = Value::map();
    texture.set("type", Value::string("image"));
    const std::filesystem::path file = look.texture ? mesh.parent_path() / *look.texture : mesh;
    texture.set("file", Value::string(file.string()));
    if (!look.texture) texture.set("image", Value::integer(*look.embedded_texture));
    material.set("texture", std::move(texture));
  }
  return built_in(render::material_schema(), material.yaml());
}

}  // namespace

Schema looks_schema() {
  return dictionary(
      "Material of each part of the asset, by the name of the part in its file. `all` stands for every part "
      "that is not named; without it such a part looks as its glTF or GLB file says, and is grey where that "
      "says nothing.",
      string("Name of a material."));
}

void check_looks(const Value& item, const std::vector<std::string>& part_names) {
  for (const auto& [part, material] : item["looks"].entries()) {
    if (part == "all" || std::find(part_names.begin(), part_names.end(), part) != part_names.end()) continue;
    const std::string nearest = nearest_word(part, part_names);
    throw Error(ErrorKind::usage, item["name"].as_string() + ": its mesh has no part called '" + part + "'",
                !nearest.empty()     ? "did you mean '" + nearest + "'?"
                : part_names.empty() ? "its parts have no names; `all` stands for the whole mesh"
                                     : "its parts are " + join_words(part_names),
                material.where());
  }
}

void check_asset_looks(const Scene& scene, const Value& item) {
  for (const PartLook& look : own_looks(scene, item)) {
    if (!look.texture) continue;
    const std::filesystem::path mesh = scene.resolve_path(item["mesh"].as_string());
    const std::filesystem::path image = mesh.parent_path() / *look.texture;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(image, ignored)) continue;
    throw Error(
        ErrorKind::geometry,
        mesh.string() + " refers to an image that does not exist: " + image.lexically_normal().string(),
        "put it there, or give the part '" + look.part + "' a material in `looks`");
  }
}

render::Looks scene_looks(const Scene& scene) {
  render::Looks looks;
  looks.folder = scene.folder;
  for (const auto& [name, material] : scene.settings["materials"].entries()) looks.materials[name] = material;
  looks.materials[kDefaultMaterial] = built_in(render::material_schema(), "{type: diffuse}");
  for (const char* list : {"bodies", "colliders", "props"}) {
    for (const Value& item : scene.settings[list].items()) {
      for (const PartLook& look : own_looks(scene, item)) {
        const std::string name = own_material(item, look.part);
        if (!looks.materials.contains(name)) {
          looks.materials[name] = make_material(look, item["mesh"].as_string());
        }
      }
    }
  }
  looks.lights = scene.settings["lights"].items();
  if (looks.lights.empty()) looks.lights = {built_in(render::light_schema(), "{type: environment}")};
  return looks;
}

std::vector<std::string> part_materials(const Value& item, const std::vector<std::string>& part_names,
                                        const render::Looks& looks) {
  check_looks(item, part_names);
  const Value& given = item["looks"];
  const auto material = [&](const std::string& part) -> std::string {
    if (given.has(part)) return given[part].as_string();
    if (given.has("all")) return given["all"].as_string();
    const std::string own = item.has("mesh") ? own_material(item, part) : "";
    return looks.materials.contains(own) ? own : kDefaultMaterial;
  };
  std::vector<std::string> materials;
  for (const std::string& part : part_names) materials.push_back(material(part));
  if (materials.empty()) materials.push_back(material("all"));
  return materials;
}

}  // namespace vivify::pipeline
