#include "sim/contact/collider_shape.h"

#include <array>

#include "common/registry.h"
#include "sim/contact/shapes/shapes.h"

namespace vivify::sim {
namespace {

constexpr std::array<ColliderShapeEntry, 4> kShapes = {{
    {"plane", plane_schema, make_plane},
    {"sphere", sphere_schema, make_sphere},
    {"capsule", capsule_schema, make_capsule},
    {"height_field", height_field_schema, make_height_field},
}};

}  // namespace

std::span<const ColliderShapeEntry> collider_shapes() { return kShapes; }

Schema collider_shape_schema() {
  Schema schema = variant(
      "A shape given by a few numbers, in the place of `mesh`; `position`, `scale` and `heading_deg` "
      "apply to it too.",
      "type");
  for (const ColliderShapeEntry& entry : collider_shapes()) {
    schema = std::move(schema).option(std::string(entry.name), entry.schema());
  }
  return schema;
}

std::unique_ptr<ColliderShape> make_collider_shape(const Value& settings, const ShapePlace& place) {
  return find_entry(collider_shapes(), settings["type"].as_string(), "shape of colliders")
      .make(settings, place);
}

}  // namespace vivify::sim
