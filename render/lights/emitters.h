// The shining triangles of a frame as one light.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/lights/light.h"
#include "render/warp.h"

namespace vivify::render {

// Triangles are chosen by their power and sampled evenly over their area; they shine on their front side.
class TriangleEmitters : public Light {
 public:
  struct Emitter {
    std::array<Vec3, 3> corners;  // counter-clockwise is the shining side
    Vec3 radiance;
    std::uint32_t triangle;  // its index in the scene
  };

  // `triangle_count` triangles are in the scene.
  TriangleEmitters(std::vector<Emitter> emitters, std::size_t triangle_count);

  bool empty() const { return emitters_.empty(); }
  float importance(const Vec3& p) const override;
  bool sample(const Vec3& p, const Vec2& u, LightSample& sample) const override;
  // Density for a direction that meets `triangle` (any of the scene) at `distance` under `cosine` to its
  // front.
  float triangle_pdf(std::uint32_t triangle, float distance, float cosine) const;
  // The triangles are met as surfaces of the scene, so a ray does not meet this light, and pdf is by
  // triangle_pdf.
  float pdf(const Vec3&, const Vec3&) const override { return 0; }
  Vec3 radiance(const Ray&) const override { return {}; }

 private:
  std::vector<Emitter> emitters_;
  std::vector<float> pdf_area_;           // by emitter
  std::vector<std::int32_t> emitter_of_;  // by triangle of the scene, −1: none
  Distribution1D choice_;
  Vec3 center_;
  float power_ = 0;  // radiance times area, luminance
  float radius2_ = 0;
};

}  // namespace vivify::render
