// A distant light that covers a small disk of the sky.
#include "render/lights/light.h"
#include "render/textures/texture.h"
#include "render/warp.h"

namespace vivify::render {
namespace {

constexpr float kDegree = kPi / 180;

class SunLight : public Light {
 public:
  explicit SunLight(const Value& value) : Light(value["visible"].as_bool()), basis_(direction_of(value)) {
    const float half = 0.5f * kDegree * static_cast<float>(value["angle_deg"].as_number());
    const float sine = std::sin(0.5f * half);
    cone_ = 2 * sine * sine;
    const float s = std::sin(half);
    radiance_ =
        to_vec3(value["color"]) * (static_cast<float>(value["irradiance"].as_number()) / (kPi * s * s));
  }

  float importance(const Vec3&) const override { return luminance(radiance_) * 2 * kPi * cone_; }

  bool sample(const Vec3&, const Vec2& u, LightSample& sample) const override {
    sample.direction = basis_.to_world(sample_cone(u, cone_));
    sample.distance = std::numeric_limits<float>::infinity();
    sample.radiance = radiance_;
    sample.pdf = cone_pdf(cone_);
    return true;
  }

  float pdf(const Vec3&, const Vec3&) const override { return cone_pdf(cone_); }

  Vec3 radiance(const Ray& ray) const override {
    if (ray.tmax != std::numeric_limits<float>::infinity()) return {};
    if (dot(ray.direction, basis_.n) <= 0) return {};
    // 1 − cos θ from the sine, which keeps its digits near the axis.
    const float sin2 = length2(cross(ray.direction, basis_.n));
    return sin2 / (1 + std::sqrt(std::max(0.0f, 1 - sin2))) <= cone_ ? radiance_ : Vec3();
  }

 private:
  static Vec3 direction_of(const Value& value) {
    const float elevation = kDegree * static_cast<float>(value["elevation_deg"].as_number());
    const float azimuth = kDegree * static_cast<float>(value["azimuth_deg"].as_number());
    return {std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
            -std::cos(elevation) * std::cos(azimuth)};
  }

  Basis basis_;
  float cone_ = 0;  // 1 − cos of half the angle
  Vec3 radiance_;
};

}  // namespace

LightEntry sun_light() {
  return {
      "sun",
      [] {
        return object("A distant light that covers a small disk of the sky.")
            .field("azimuth_deg", number("Where it stands: 0 is −z, 90 is +x.").unit("°").initially(-40))
            .field("elevation_deg",
                   number("How high it stands.").unit("°").at_least(-90).at_most(90).initially(45))
            .field("angle_deg", number("Its diameter in the sky; the real sun has 0.53.")
                                    .unit("°")
                                    .at_least(0.1)
                                    .at_most(90)
                                    .initially(2))
            .field("color",
                   vector("Colour of the light (linear Rec. 709).", 3).at_least(0).initially({1, 0.95, 0.85}))
            .field("irradiance", number("Of a surface that faces it.").unit("W/m²").at_least(0).initially(5))
            .field("visible", boolean("Whether the camera sees its disk.").initially(true));
      },
      [](const Value& value, const std::filesystem::path&) -> std::unique_ptr<Light> {
        return std::make_unique<SunLight>(value);
      }};
}

}  // namespace vivify::render
