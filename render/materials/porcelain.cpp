// A clear glaze over a matt body: GGX dielectric coat, and below it a diffuse layer that gets what the coat
// lets through. The coupling f_d = c (1 − E(θo)) (1 − E(θi)) / (π (1 − E_mean)) [Ashikhmin and Shirley 2000;
// Kelemen and Szirmay-Kalos 2001] is reciprocal and keeps all light when the colour c is 1. Glazed china,
// varnished wood, plastic.
#include "render/materials/albedo_table.h"
#include "render/materials/material.h"
#include "render/materials/microfacet.h"
#include "render/warp.h"

namespace vivify::render {
namespace {

class Porcelain : public Material {
 public:
  Porcelain(ColorSource color, float roughness, float ior)
      : Material(std::move(color)),
        ggx_(alpha_of(roughness)),
        ior_(ior),
        coat_([this](const Vec3& wo, const Vec2& u) {
          const Vec3 m = ggx_.sample_normal(wo, u);
          const Vec3 wi = reflect(wo, m);
          return wi.z > 0 ? fresnel_dielectric(dot(wo, m), ior_) * ggx_.g2(wo, wi) / ggx_.g1(wo) : 0.0f;
        }) {}

  BsdfValue evaluate(const Vec3& color, const Vec3& outgoing, const Vec3& incoming) const override {
    if (outgoing.z * incoming.z <= 0) return {};
    const Vec3 wo = {outgoing.x, outgoing.y, std::abs(outgoing.z)};
    const Vec3 wi = {incoming.x, incoming.y, std::abs(incoming.z)};
    const Vec3 m = normalize(wo + wi);
    const float d = ggx_.density(m) / (4 * wo.z);
    const float reflected = coat_.at(wo.z);
    const float coat = fresnel_dielectric(dot(wo, m), ior_) * d * ggx_.g2(wo, wi);
    const float body = (1 - reflected) * (1 - coat_.at(wi.z)) * wi.z / (kPi * (1 - coat_.average()));
    const float share = coat_share(color, reflected);
    return {Vec3(coat) + color * body, share * ggx_.g1(wo) * d + (1 - share) * wi.z / kPi};
  }

  bool sample(const Vec3& color, const Vec3& outgoing, const Vec3& u, BsdfSample& sample) const override {
    const Vec3 wo = {outgoing.x, outgoing.y, std::abs(outgoing.z)};
    if (u.z < coat_share(color, coat_.at(wo.z))) {
      sample.wi = reflect(wo, ggx_.sample_normal(wo, {u.x, u.y}));
    } else {
      sample.wi = sample_cosine_hemisphere({u.x, u.y});
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
  // Share of the samples that the coat gets: more than it reflects, because what it mirrors is far more
  // uneven than what the body gathers, and the light of the body is found by sampling the lights as well.
  static float coat_share(const Vec3& color, float reflected) {
    constexpr float kLeast = 0.4f;
    const float body = (1 - reflected) * luminance(color);
    return std::max(kLeast, reflected / (reflected + body + 1e-6f));
  }

  Ggx ggx_;
  float ior_;
  AlbedoTable coat_;
};

}  // namespace

MaterialEntry porcelain_material() {
  return {"porcelain",
          [] {
            return with_color(object("A clear glaze over a matt body: china, varnished wood, plastic."),
                              {0.8, 0.8, 0.8}, "Colour of the body below the glaze (linear Rec. 709).")
                .field("roughness", number("Of the glaze: 0.05 is polished, 1 is dull.")
                                        .at_least(kMirrorRoughness)
                                        .at_most(1)
                                        .initially(0.1))
                .field("ior", number("Index of refraction of the glaze.").above(1).at_most(3).initially(1.5));
          },
          [](const Value& value, const std::filesystem::path& folder) -> std::unique_ptr<Material> {
            return std::make_unique<Porcelain>(ColorSource(value, folder),
                                               static_cast<float>(value["roughness"].as_number()),
                                               static_cast<float>(value["ior"].as_number()));
          }};
}

}  // namespace vivify::render
