// A black surface that shines by itself on its outer side.
#include "render/materials/material.h"

namespace vivify::render {
namespace {

class Emissive : public Material {
 public:
  Emissive(ColorSource color, float radiance) : Material(std::move(color)), radiance_(radiance) {}

  BsdfValue evaluate(const Vec3&, const Vec3&, const Vec3&) const override { return {}; }
  bool sample(const Vec3&, const Vec3&, const Vec3&, BsdfSample&) const override { return false; }
  Vec3 emission(const Vec3& color) const override { return color * radiance_; }

 private:
  float radiance_;
};

}  // namespace

MaterialEntry emissive_material() {
  return {"emissive",
          [] {
            return object("A surface that shines by itself on its outer side and reflects nothing.")
                .field("color",
                       vector("Colour of the light (linear Rec. 709).", 3).at_least(0).initially({1, 1, 1}))
                .field("radiance", number("Radiance; a white sheet in the open under a sky of 1 has 1.")
                                       .unit("W/(m² sr)")
                                       .at_least(0)
                                       .initially(1));
          },
          [](const Value& value, const std::filesystem::path& folder) -> std::unique_ptr<Material> {
            return std::make_unique<Emissive>(ColorSource(value, folder),
                                              static_cast<float>(value["radiance"].as_number()));
          }};
}

}  // namespace vivify::render
