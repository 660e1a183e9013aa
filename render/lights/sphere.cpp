// A shining ball, sampled evenly over the cone of directions in which it is seen.
#include "render/lights/light.h"
#include "render/textures/texture.h"
#include "render/warp.h"

namespace vivify::render {
namespace {

class SphereLight : public Light {
 public:
  explicit SphereLight(const Value& value)
      : Light(value["visible"].as_bool()),
        center_(to_vec3(value["position"])),
        radius_(static_cast<float>(value["radius"].as_number())),
        radiance_(light_radiance(value)) {}

  float importance(const Vec3& p) const override {
    const float d2 = length2(p - center_);
    return d2 > radius_ * radius_ ? luminance(radiance_) * kPi * radius_ * radius_ / d2 : 0;
  }

  bool sample(const Vec3& p, const Vec2& u, LightSample& sample) const override {
    const float cone = one_minus_cos_max(p);
    if (cone <= 0) return false;
    const Vec3 way = center_ - p;
    const float d = length(way);
    const Vec3 local = sample_cone(u, cone);
    sample.direction = Basis(way / d).to_world(local);
    const float off2 = d * d * (local.x * local.x + local.y * local.y);
    sample.distance = d * local.z - std::sqrt(std::max(0.0f, radius_ * radius_ - off2));
    sample.radiance = radiance_;
    sample.pdf = cone_pdf(cone);
    return true;
  }

  float pdf(const Vec3& p, const Vec3&) const override {
    const float cone = one_minus_cos_max(p);
    return cone > 0 ? cone_pdf(cone) : 0;
  }

  Vec3 radiance(const Ray& ray) const override {
    const Vec3 way = center_ - ray.origin;
    if (length2(way) <= radius_ * radius_) return {};
    const float middle = dot(way, ray.direction);
    const Vec3 off = way - ray.direction * middle;
    const float half2 = radius_ * radius_ - length2(off);
    if (middle <= 0 || half2 <= 0) return {};
    return middle - std::sqrt(half2) < ray.tmax ? radiance_ : Vec3();
  }

 private:
  float one_minus_cos_max(const Vec3& p) const {  // 0 inside the ball
    const float sin2 = radius_ * radius_ / length2(center_ - p);
    return sin2 < 1 ? sin2 / (1 + std::sqrt(1 - sin2)) : 0;
  }

  Vec3 center_;
  float radius_;
  Vec3 radiance_;
};

}  // namespace

LightEntry sphere_light() {
  return {"sphere",
          [] {
            return with_radiance(
                object("A ball that shines outward.")
                    .field("position", vector("Its centre.", 3).unit("m").required())
                    .field("radius", number("Its radius.").unit("m").above(0).initially(0.1)),
                30);
          },
          [](const Value& value, const std::filesystem::path&) -> std::unique_ptr<Light> {
            return std::make_unique<SphereLight>(value);
          }};
}

}  // namespace vivify::render
