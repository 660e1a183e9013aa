// A rectangle that shines to one side, sampled evenly over the solid angle it covers [Ureña et al. 2013].
#include "render/lights/light.h"
#include "render/textures/texture.h"

namespace vivify::render {
namespace {

class AreaLight : public Light {
 public:
  explicit AreaLight(const Value& value)
      : Light(value["visible"].as_bool()),
        center_(to_vec3(value["position"])),
        normal_(aim(value)),
        radiance_(light_radiance(value)) {
    const Eigen::VectorXd size = value["size"].as_vector();
    width_ = static_cast<float>(size[0]);
    height_ = static_cast<float>(size[1]);
    if (!(width_ > 0 && height_ > 0)) {
      throw Error(ErrorKind::usage, "an area light's size must be positive", "", value["size"].where());
    }
    // The first side is level, unless the light shines straight up or down.
    const Vec3 up = std::abs(normal_.y) < 0.999f ? Vec3(0, 1, 0) : Vec3(0, 0, -1);
    side_ = normalize(cross(up, normal_));
    rise_ = cross(normal_, side_);
  }

  float importance(const Vec3& p) const override {
    const Vec3 d = p - center_;
    const float h = dot(d, normal_);
    if (h <= 0) return 0;
    const float r2 = length2(d);
    const float area = width_ * height_;
    return luminance(radiance_) * area * h / (std::sqrt(r2) * (r2 + area));
  }

  bool sample(const Vec3& p, const Vec2& u, LightSample& sample) const override {
    const Quad q = seen_from(p);
    if (!q.valid) return false;
    Vec2 at;
    if (q.small) {
      at = {q.x0 + u.x * width_, q.y0 + u.y * height_};
    } else {
      // Ureña et al. 2013, section 3: first the meridian, then the height on it.
      const float au = u.x * q.solid_angle + q.k;
      const float fu = (std::cos(au) * q.b0 - q.b1) / std::sin(au);
      float cu = std::copysign(1 / std::sqrt(fu * fu + q.b0 * q.b0), fu);
      cu = std::clamp(cu, -1.0f, 1.0f);
      const float z0 = -q.h;
      float xu = -(cu * z0) / std::max(std::sqrt(std::max(0.0f, 1 - cu * cu)), 1e-7f);
      xu = std::clamp(xu, q.x0, q.x0 + width_);
      const float d = std::sqrt(xu * xu + z0 * z0);
      const float y1 = q.y0 + height_;
      const float h0 = q.y0 / std::sqrt(d * d + q.y0 * q.y0);
      const float h1 = y1 / std::sqrt(d * d + y1 * y1);
      const float hv = h0 + u.y * (h1 - h0);
      const float hv2 = hv * hv;
      const float yv = hv2 < 1 - 1e-6f ? hv * d / std::sqrt(1 - hv2) : y1;
      at = {xu, std::clamp(yv, q.y0, y1)};
    }
    const Vec3 way = side_ * at.x + rise_ * at.y - normal_ * q.h;
    const float r2 = length2(way);
    sample.distance = std::sqrt(r2);
    sample.direction = way / sample.distance;
    sample.radiance = radiance_;
    sample.pdf = q.small ? r2 * sample.distance / (q.h * width_ * height_) : 1 / q.solid_angle;
    return true;
  }

  float pdf(const Vec3& p, const Vec3& direction) const override {
    const Quad q = seen_from(p);
    if (!q.valid) return 0;
    if (!q.small) return 1 / q.solid_angle;
    const float cosine = -dot(direction, normal_);
    if (cosine <= 0) return 0;
    const float r = q.h / cosine;
    return r * r / (cosine * width_ * height_);
  }

  Vec3 radiance(const Ray& ray) const override {
    const float cosine = -dot(ray.direction, normal_);
    if (cosine <= 0) return {};
    const Vec3 d = ray.origin - center_;
    const float t = dot(d, normal_) / cosine;
    if (!(t > 0 && t < ray.tmax)) return {};
    const Vec3 at = d + ray.direction * t;
    const bool inside =
        std::abs(dot(at, side_)) <= 0.5f * width_ && std::abs(dot(at, rise_)) <= 0.5f * height_;
    return inside ? radiance_ : Vec3();
  }

 private:
  // The rectangle in a frame at p with axes side, rise and normal: x0 <= x <= x0 + width and so on, at z =
  // −h.
  struct Quad {
    bool valid = false, small = false;
    float x0, y0, h;
    float solid_angle, b0, b1, k;
  };

  Quad seen_from(const Vec3& p) const {
    Quad q;
    const Vec3 d = center_ - p;
    q.h = -dot(d, normal_);
    if (!(q.h > 0)) return q;
    q.valid = true;
    q.x0 = dot(d, side_) - 0.5f * width_;
    q.y0 = dot(d, rise_) - 0.5f * height_;
    const float x1 = q.x0 + width_;
    const float y1 = q.y0 + height_;
    const float z0 = -q.h;
    // Inner angles of the spherical rectangle from the normals of its four sides; z components only are
    // needed.
    const float nz0 = -q.y0 / std::sqrt(z0 * z0 + q.y0 * q.y0);
    const float nz1 = x1 / std::sqrt(z0 * z0 + x1 * x1);
    const float nz2 = y1 / std::sqrt(z0 * z0 + y1 * y1);
    const float nz3 = -q.x0 / std::sqrt(z0 * z0 + q.x0 * q.x0);
    const float g0 = std::acos(std::clamp(-nz0 * nz1, -1.0f, 1.0f));
    const float g1 = std::acos(std::clamp(-nz1 * nz2, -1.0f, 1.0f));
    const float g2 = std::acos(std::clamp(-nz2 * nz3, -1.0f, 1.0f));
    const float g3 = std::acos(std::clamp(-nz3 * nz0, -1.0f, 1.0f));
    q.b0 = nz0;
    q.b1 = nz2;
    q.k = 2 * kPi - g2 - g3;
    q.solid_angle = g0 + g1 - q.k;
    // The difference of angles has lost its digits for a small light; its area does as well there.
    q.small = !(q.solid_angle > 0.01f);
    return q;
  }

  Vec3 center_, normal_, side_, rise_, radiance_;
  float width_, height_;
};

}  // namespace

LightEntry area_light() {
  return {"area",
          [] {
            return with_radiance(
                object("A rectangle that shines to one side.")
                    .field("position", vector("Its centre.", 3).unit("m").required())
                    .field("target", vector("The point it faces.", 3).unit("m").initially({0, 0, 0}))
                    .field("size", vector("Width and height.", 2).unit("m").at_least(0).initially({1, 1})),
                10);
          },
          [](const Value& value, const std::filesystem::path&) -> std::unique_ptr<Light> {
            return std::make_unique<AreaLight>(value);
          }};
}

}  // namespace vivify::render
