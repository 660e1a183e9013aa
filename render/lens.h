// Rays of a thin-lens camera.
#pragma once

#include <optional>

#include "render/accel.h"
#include "render/scene.h"

namespace vivify::render {

class Lens {
 public:
  // Throws Error(usage) for a camera that looks nowhere (position and target, or view and up, coincide).
  Lens(const Camera& camera, int width, int height);

  // The ray through a point of the picture (pixels, from the upper left corner) and a point of the unit
  // square of the lens.
  Ray ray(const Vec2& pixel, const Vec2& lens) const;

  // Where a point of the world is seen (pixels, from the upper left corner); nothing behind the lens.
  std::optional<Vec2> project(const Eigen::Vector3d& point) const;

  // Angle that a pixel covers in the middle of the picture (radians).
  float pixel_angle() const { return pixel_angle_; }

 private:
  Vec3 position_, right_, up_, forward_;
  float half_width_, half_height_;  // of the picture at distance 1
  float pixels_x_, pixels_y_;
  float radius_, focus_;
  float pixel_angle_;
};

}  // namespace vivify::render
