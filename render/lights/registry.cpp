#include <array>
#include <string>
#include <utility>

#include "common/registry.h"
#include "render/lights/light.h"
#include "render/scene.h"
#include "render/textures/texture.h"

namespace vivify::render {

LightEntry area_light();
LightEntry disk_light();
LightEntry sphere_light();
LightEntry sun_light();
LightEntry environment_light();
LightEntry sky_light();
LightEntry studio_light();

std::span<const LightEntry> light_registry() {
  static const std::array entries = {area_light(),        disk_light(), sphere_light(), sun_light(),
                                     environment_light(), sky_light(),  studio_light()};
  return entries;
}

std::unique_ptr<Light> make_light(const Value& value, const std::filesystem::path& folder) {
  return find_entry(light_registry(), value["type"].as_string(), "light").make(value, folder);
}

Schema light_schema() {
  Schema schema = variant("What shines on the scene.", "type");
  for (const LightEntry& entry : light_registry()) {
    schema = std::move(schema).option(std::string(entry.name), entry.schema());
  }
  return schema;
}

Schema with_radiance(Schema&& schema, double radiance) {
  return std::move(schema)
      .field("color", vector("Colour of the light (linear Rec. 709).", 3).at_least(0).initially({1, 1, 1}))
      .field("radiance",
             number("Radiance of the shining surface.").unit("W/(m² sr)").at_least(0).initially(radiance))
      .field("visible", boolean("Whether the camera sees the light itself.").initially(true));
}

Vec3 light_radiance(const Value& value) {
  return to_vec3(value["color"]) * static_cast<float>(value["radiance"].as_number());
}

Vec3 aim(const Value& value) {
  const Vec3 way = to_vec3(value["target"]) - to_vec3(value["position"]);
  if (length2(way) == 0) {
    throw Error(ErrorKind::usage, "a light's position and target are the same point", "move its target",
                value.where());
  }
  return normalize(way);
}

}  // namespace vivify::render
