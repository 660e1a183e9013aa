// Clear or frosted dielectric [Walter et al. 2007]. The frosted kind is divided by its directional albedo, so
// that it keeps all light; the price is that it is not reciprocal.
#include "render/materials/albedo_table.h"
#include "render/materials/material.h"
#include "render/materials/microfacet.h"

namespace vivify::render {
namespace {

class Glass : public Material {
 public:
  Glass(ColorSource color, float roughness, float ior)
      : Material(std::move(color)),
        smooth_(roughness < static_cast<float>(kMirrorRoughness)),
        ggx_(alpha_of(std::max(roughness, static_cast<float>(kMirrorRoughness)))),
        ior_(ior) {
    if (smooth_) return;
    const auto albedo = [this](float eta) {
      return AlbedoTable([this, eta](const Vec3& wo, const Vec2& u) {
        const Vec3 m = ggx_.sample_normal(wo, u);
        const float f = fresnel_dielectric(dot(wo, m), eta);
        const Vec3 up = reflect(wo, m);
        Vec3 down;
        float weight = up.z > 0 ? f * ggx_.g2(wo, up) : 0;
        if (refract(wo, m, eta, down) && down.z < 0) weight += (1 - f) * ggx_.g2(wo, -down);
        return weight / ggx_.g1(wo);
      });
    };
    outside_ = albedo(ior);
    inside_ = albedo(1 / ior);
  }

  bool is_delta() const override { return smooth_; }
  bool is_reciprocal() const override { return false; }

  BsdfValue evaluate(const Vec3& color, const Vec3& outgoing, const Vec3& incoming) const override {
    if (smooth_ || outgoing.z == 0 || incoming.z == 0) return {};
    const bool from_outside = outgoing.z > 0;
    const float eta = from_outside ? ior_ : 1 / ior_;
    const Vec3 wo = from_outside ? outgoing : Vec3(outgoing.x, outgoing.y, -outgoing.z);
    const Vec3 wi = from_outside ? incoming : Vec3(incoming.x, incoming.y, -incoming.z);
    const float gain = 1 / (from_outside ? outside_ : inside_).at(wo.z);
    if (wi.z > 0) {
      const Vec3 m = normalize(wo + wi);
      const float d = fresnel_dielectric(dot(wo, m), eta) * ggx_.density(m) / (4 * wo.z);
      return {Vec3(gain * d * ggx_.g2(wo, wi)), d * ggx_.g1(wo)};
    }
    Vec3 m = wo + wi * eta;
    if (is_zero(m)) return {};
    m = normalize(m.z > 0 ? m : -m);
    const float co = dot(wo, m);
    const float ci = dot(wi, m);
    if (co <= 0 || ci >= 0) return {};
    const float denominator = ci + co / eta;
    const float d =
        (1 - fresnel_dielectric(co, eta)) * ggx_.density(m) * co * -ci / (denominator * denominator * wo.z);
    return {color * (gain * d * ggx_.g2(wo, -wi)), d * ggx_.g1(wo)};
  }

  bool sample(const Vec3& color, const Vec3& outgoing, const Vec3& u, BsdfSample& sample) const override {
    const bool from_outside = outgoing.z > 0;
    const float eta = from_outside ? ior_ : 1 / ior_;
    const Vec3 wo = {outgoing.x, outgoing.y, std::abs(outgoing.z)};
    if (wo.z == 0) return false;
    const Vec3 m = smooth_ ? Vec3(0, 0, 1) : ggx_.sample_normal(wo, {u.x, u.y});
    const float f = fresnel_dielectric(dot(wo, m), eta);
    const bool reflected = u.z < f || !refract(wo, m, eta, sample.wi);
    if (reflected) sample.wi = reflect(wo, m);
    if (reflected != (sample.wi.z > 0)) return false;
    if (smooth_) {
      sample.delta = true;
      sample.pdf = reflected ? f : 1 - f;
      sample.weight = reflected ? Vec3(1) : color;
    }
    if (!from_outside) sample.wi.z = -sample.wi.z;
    if (smooth_) return true;
    const BsdfValue value = evaluate(color, outgoing, sample.wi);
    if (value.pdf <= 0) return false;
    sample.weight = value.value / value.pdf;
    sample.pdf = value.pdf;
    return true;
  }

 private:
  bool smooth_;
  Ggx ggx_;
  float ior_;
  AlbedoTable outside_, inside_;
};

}  // namespace

MaterialEntry glass_material() {
  return {
      "glass",
      [] {
        return with_color(object("Clear or frosted glass; the surface must be closed."), {1, 1, 1},
                          "What is left of the light at each crossing of the surface (linear Rec. 709).")
            .field("roughness",
                   number("Below 0.05 the glass is clear, 1 is frosted.").at_least(0).at_most(1).initially(0))
            .field("ior", number("Index of refraction.").above(1).at_most(3).initially(1.5));
      },
      [](const Value& value, const std::filesystem::path& folder) -> std::unique_ptr<Material> {
        return std::make_unique<Glass>(ColorSource(value, folder),
                                       static_cast<float>(value["roughness"].as_number()),
                                       static_cast<float>(value["ior"].as_number()));
      }};
}

}  // namespace vivify::render
