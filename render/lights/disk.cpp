// A disk that shines to one side, sampled evenly over its area.
#include "render/lights/light.h"
#include "render/textures/texture.h"
#include "render/warp.h"

namespace vivify::render {
namespace {

class DiskLight : public Light {
 public:
  explicit DiskLight(const Value& value)
      : Light(value["visible"].as_bool()),
        center_(to_vec3(value["position"])),
        basis_(aim(value)),
        radius_(static_cast<float>(value["radius"].as_number())),
        radiance_(light_radiance(value)) {}

  float importance(const Vec3& p) const override {
    const Vec3 d = p - center_;
    const float h = dot(d, basis_.n);
    if (h <= 0) return 0;
    const float r2 = length2(d);
    return luminance(radiance_) * area() * h / (std::sqrt(r2) * (r2 + area()));
  }

  bool sample(const Vec3& p, const Vec2& u, LightSample& sample) const override {
    const float h = dot(p - center_, basis_.n);
    if (h <= 0) return false;
    const Vec2 d = sample_disk(u);
    const Vec3 way = center_ + (basis_.s * d.x + basis_.t * d.y) * radius_ - p;
    const float r2 = length2(way);
    sample.distance = std::sqrt(r2);
    sample.direction = way / sample.distance;
    sample.radiance = radiance_;
    sample.pdf = r2 * sample.distance / (h * area());
    return true;
  }

  float pdf(const Vec3& p, const Vec3& direction) const override {
    const float h = dot(p - center_, basis_.n);
    const float cosine = -dot(direction, basis_.n);
    if (h <= 0 || cosine <= 0) return 0;
    const float r = h / cosine;
    return r * r / (cosine * area());
  }

  Vec3 radiance(const Ray& ray) const override {
    const float cosine = -dot(ray.direction, basis_.n);
    if (cosine <= 0) return {};
    const Vec3 d = ray.origin - center_;
    const float t = dot(d, basis_.n) / cosine;
    if (!(t > 0 && t < ray.tmax)) return {};
    return length2(d + ray.direction * t) <= radius_ * radius_ ? radiance_ : Vec3();
  }

 private:
  float area() const { return kPi * radius_ * radius_; }

  Vec3 center_;
  Basis basis_;
  float radius_;
  Vec3 radiance_;
};

}  // namespace

LightEntry disk_light() {
  return {"disk",
          [] {
            return with_radiance(
                object("A disk that shines to one side.")
                    .field("position", vector("Its centre.", 3).unit("m").required())
                    .field("target", vector("The point it faces.", 3).unit("m").initially({0, 0, 0}))
                    .field("radius", number("Its radius.").unit("m").above(0).initially(0.5)),
                10);
          },
          [](const Value& value, const std::filesystem::path&) -> std::unique_ptr<Light> {
            return std::make_unique<DiskLight>(value);
          }};
}

}  // namespace vivify::render
