// Rough conductor: GGX with Schlick's Fresnel factor, and the light of further bounces between the
// microfacets in the reciprocal form of Kulla and Conty 2017, so that a metal without absorption keeps all
// light.
#include "render/materials/albedo_table.h"
#include "render/materials/material.h"
#include "render/materials/microfacet.h"

namespace vivify::render {
namespace {

class Metal : public Material {
 public:
  Metal(ColorSource color, float roughness)
      : Material(std::move(color)), ggx_(alpha_of(roughness)), albedo_([this](const Vec3& wo, const Vec2& u) {
          const Vec3 wi = reflect(wo, ggx_.sample_normal(wo, u));
          return wi.z > 0 ? ggx_.g2(wo, wi) / ggx_.g1(wo) : 0.0f;
        }) {}

  BsdfValue evaluate(const Vec3& color, const Vec3& outgoing, const Vec3& incoming) const override {
    if (outgoing.z * incoming.z <= 0) return {};
    const Vec3 wo = {outgoing.x, outgoing.y, std::abs(outgoing.z)};
    const Vec3 wi = {incoming.x, incoming.y, std::abs(incoming.z)};
    const Vec3 m = normalize(wo + wi);
    const float d = ggx_.density(m);
    const float lost = 1 - albedo_.at(wo.z);
    const Vec3 first = fresnel_schlick(dot(wo, m), color) * (d * ggx_.g2(wo, wi) / (4 * wo.z));
    const float spread =
        lost * (1 - albedo_.at(wi.z)) * wi.z / (kPi * std::max(1 - albedo_.average(), 1e-6f));
    const float share = lost_share(lost);
    return {first + further_bounces(color) * spread,
            (1 - share) * ggx_.g1(wo) * d / (4 * wo.z) + share * albedo_.lost_pdf(wi.z)};
  }

  bool sample(const Vec3& color, const Vec3& outgoing, const Vec3& u, BsdfSample& sample) const override {
    const Vec3 wo = {outgoing.x, outgoing.y, std::abs(outgoing.z)};
    if (u.z < lost_share(1 - albedo_.at(wo.z))) {
      sample.wi = albedo_.sample_lost({u.x, u.y});
    } else {
      sample.wi = reflect(wo, ggx_.sample_normal(wo, {u.x, u.y}));
    }
    if (sample.wi.z <= 0) return false;
    const BsdfValue f = evaluate(color, wo, sample.wi);
    if (f.pdf <= 0) return false;
    sample.weight = f.value / f.pdf;
    sample.pdf = f.pdf;
    if (outgoing.z < 0) sample.wi.z = -sample.wi.z;
    return true;
  }

 private:
  static float lost_share(float lost) { return std::clamp(lost, 0.0f, 1.0f); }

  // Mean reflectance of all orders of further bounces; 1 for a white metal.
  Vec3 further_bounces(const Vec3& f0) const {
    const float e = albedo_.average();
    const auto channel = [e](float f) {
      const float mean = f + (1 - f) / 21;
      return mean * mean * e / (1 - mean * (1 - e));
    };
    return {channel(f0.x), channel(f0.y), channel(f0.z)};
  }

  Ggx ggx_;
  AlbedoTable albedo_;  // of the first bounce on a white metal
};

}  // namespace

MaterialEntry metal_material() {
  return {
      "metal",
      [] {
        return with_color(
                   object("A metal with a rough to polished surface (GGX)."), {0.95, 0.93, 0.88},
                   "Reflectance seen from the front (linear Rec. 709): silver 0.95 0.93 0.88, gold 1.00 "
                   "0.77 0.34, copper 0.96 0.64 0.54, iron 0.56 0.57 0.58.")
            .field(
                "roughness",
                number("0.05 is polished, 1 is dull.").at_least(kMirrorRoughness).at_most(1).initially(0.2));
      },
      [](const Value& value, const std::filesystem::path& folder) -> std::unique_ptr<Material> {
        return std::make_unique<Metal>(ColorSource(value, folder),
                                       static_cast<float>(value["roughness"].as_number()));
      }};
}

}  // namespace vivify::render
