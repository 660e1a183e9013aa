#include "render/textures/texture.h"

#include <array>
#include <utility>

#include "common/registry.h"

namespace vivify::render {

TextureEntry image_texture();    // image.cpp
TextureEntry checker_texture();  // checker.cpp

std::span<const TextureEntry> texture_registry() {
  static const std::array entries = {image_texture(), checker_texture()};
  return entries;
}

ColorSource::ColorSource(const Value& value, const std::filesystem::path& folder)
    : color_(to_vec3(value["color"])) {
  if (!value.has("texture")) return;
  const Value& texture = value["texture"];
  const std::string& type = texture["type"].as_string();
  if (type == "none") return;
  texture_ = find_entry(texture_registry(), type, "texture").make(texture, folder);
}

Schema with_color(Schema&& schema, std::vector<double> color, const char* doc) {
  Schema texture = variant("What the colour is multiplied by.", "type").initially("none");
  texture = std::move(texture).option("none", object("Nothing: one colour everywhere."));
  for (const TextureEntry& entry : texture_registry()) {
    texture = std::move(texture).option(std::string(entry.name), entry.schema());
  }
  return std::move(schema)
      .field("color", vector(doc, 3).at_least(0).initially(std::move(color)))
      .field("texture", std::move(texture));
}

Vec3 to_vec3(const Value& value) {
  const Eigen::Vector3d v = value.as_vector3();
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

}  // namespace vivify::render
