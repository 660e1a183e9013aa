#include "render/lens.h"

#include <Eigen/Geometry>
#include <cmath>

#include "common/error.h"
#include "render/warp.h"

namespace vivify::render {
namespace {
Vec3 to_float(const Eigen::Vector3d& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}
}  // namespace

Lens::Lens(const Camera& camera, int width, int height)
    : position_(to_float(camera.position)),
      pixels_x_(static_cast<float>(width)),
      pixels_y_(static_cast<float>(height)),
      radius_(static_cast<float>(camera.aperture_radius_m)) {
  const Eigen::Vector3d way = camera.target - camera.position;
  const double distance = way.norm();
  if (!(distance > 0) || !std::isfinite(distance)) {
    throw Error(ErrorKind::usage, "the camera's position and target are the same point", "move its target");
  }
  const Eigen::Vector3d forward = way / distance;
  const Eigen::Vector3d right = forward.cross(camera.up);
  if (!(right.norm() > 1e-6 * camera.up.norm())) {
    throw Error(ErrorKind::usage, "the camera looks along its up direction", "give `up` another direction");
  }
  forward_ = to_float(forward);
  right_ = to_float(right.normalized());
  up_ = to_float(right.normalized().cross(forward));
  const double half = std::tan(0.5 * camera.fov_deg * (3.14159265358979323846 / 180));
  half_height_ = static_cast<float>(half);
  half_width_ = static_cast<float>(half * width / height);
  focus_ = static_cast<float>(camera.focus_m > 0 ? camera.focus_m : distance);
  pixel_angle_ = 2 * half_height_ / pixels_y_;
}

std::optional<Vec2> Lens::project(const Eigen::Vector3d& point) const {
  const Vec3 way = to_float(point) - position_;
  const float depth = dot(way, forward_);
  if (!(depth > 0)) return std::nullopt;
  const float x = dot(way, right_) / (depth * half_width_), y = dot(way, up_) / (depth * half_height_);
  return Vec2{(1 + x) / 2 * pixels_x_, (1 - y) / 2 * pixels_y_};
}

Ray Lens::ray(const Vec2& pixel, const Vec2& lens) const {
  const float x = (2 * pixel.x / pixels_x_ - 1) * half_width_;
  const float y = (1 - 2 * pixel.y / pixels_y_) * half_height_;
  const Vec3 through = forward_ + right_ * x + up_ * y;
  if (radius_ <= 0) return {position_, normalize(through)};
  const Vec2 d = sample_disk(lens);
  const Vec3 shift = right_ * (d.x * radius_) + up_ * (d.y * radius_);
  return {position_ + shift, normalize(through * focus_ - shift)};
}

}  // namespace vivify::render
