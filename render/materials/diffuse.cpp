// Lambert's matt surface, the same on both sides.
#include "render/materials/material.h"
#include "render/warp.h"

namespace vivify::render {
namespace {

class Diffuse : public Material {
 public:
  using Material::Material;

  BsdfValue evaluate(const Vec3& color, const Vec3& wo, const Vec3& wi) const override {
    if (wo.z * wi.z <= 0) return {};
    const float pdf = std::abs(wi.z) / kPi;
    return {color * pdf, pdf};
  }

  bool sample(const Vec3& color, const Vec3& wo, const Vec3& u, BsdfSample& sample) const override {
    sample.wi = sample_cosine_hemisphere({u.x, u.y});
    if (sample.wi.z <= 0) return false;
    sample.pdf = sample.wi.z / kPi;
    if (wo.z < 0) sample.wi.z = -sample.wi.z;
    sample.weight = color;
    return true;
  }
};

}  // namespace

MaterialEntry diffuse_material() {
  return {"diffuse",
          [] {
            return with_color(object("A matt surface that scatters light evenly (Lambert)."), {0.8, 0.8, 0.8},
                              "Share of the light that is scattered back (linear Rec. 709).");
          },
          [](const Value& value, const std::filesystem::path& folder) -> std::unique_ptr<Material> {
            return std::make_unique<Diffuse>(ColorSource(value, folder));
          }};
}

}  // namespace vivify::render
