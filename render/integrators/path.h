// Path tracing with next-event estimation [Kajiya 1986; Veach and Guibas 1995].
#pragma once

#include "render/accel.h"
#include "render/sampler.h"
#include "render/scene.h"
#include "render/world.h"

namespace vivify::render {

// What one sample of a pixel sees; the data of the first surface are zero when there is none.
struct PathSample {
  Vec3 radiance;
  bool hit = false;
  float depth = 0;  // m
  Vec3 albedo;
  Vec3 normal;
  int object = 0;
};

class PathTracer {
 public:
  // `pixel_angle`: angle that a pixel covers (radians), for the width of texture look-ups.
  PathTracer(const World& world, const RenderSettings& settings, float pixel_angle)
      : world_(world), settings_(settings), pixel_angle_(pixel_angle) {}

  // `sampler` stands at a sample of the pixel; the groups from kFirstGroup on are used.
  PathSample trace(Ray ray, Sampler& sampler);

  static constexpr std::uint32_t kFirstGroup = 1;

 private:
  Vec3 sample_light(std::size_t i, float choice, const Surface& surface, const Basis& basis, const Vec3& wo,
                    const Material& material, const Vec3& color, const Vec2& u) const;

  const World& world_;
  const RenderSettings& settings_;
  float pixel_angle_;
  LightChoice choice_;
};

}  // namespace vivify::render
