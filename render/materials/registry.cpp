#include <array>
#include <string>
#include <utility>

#include "common/registry.h"
#include "render/materials/material.h"
#include "render/scene.h"

namespace vivify::render {

MaterialEntry diffuse_material();
MaterialEntry porcelain_material();
MaterialEntry metal_material();
MaterialEntry glass_material();
MaterialEntry emissive_material();

std::span<const MaterialEntry> material_registry() {
  static const std::array entries = {diffuse_material(), porcelain_material(), metal_material(),
                                     glass_material(), emissive_material()};
  return entries;
}

std::unique_ptr<Material> make_material(const Value& value, const std::filesystem::path& folder) {
  return find_entry(material_registry(), value["type"].as_string(), "material").make(value, folder);
}

Schema material_schema() {
  Schema schema = variant("How a surface looks.", "type");
  for (const MaterialEntry& entry : material_registry()) {
    schema = std::move(schema).option(std::string(entry.name), entry.schema());
  }
  return schema;
}

}  // namespace vivify::render
