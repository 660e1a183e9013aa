// Path tracing with next-event estimation [Kajiya 1986; Veach and Guibas 1995].
#pragma once

#include <array>

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

  // Sample `index` of a pixel, along `ray`. `sampler` is of the pixel, for spp × splits samples; its groups
  // from kFirstGroup on are used.
  PathSample trace(const Ray& ray, std::uint32_t index, Sampler& sampler);

  static constexpr std::uint32_t kFirstGroup = 1;

 private:
  // A path on its way.
  struct State {
    Ray ray;
    Vec3 throughput = Vec3(1);
    Vec3 origin;              // the point that lights were sampled from
    float bsdf_pdf = 0;       // of the ray
    bool certain = true;      // camera or delta: lights could not have been sampled
    bool all_lights = false;  // at the ray's origin each light was sampled, not one of them
    bool split = false;       // the path has met a rough surface
    bool matt = false;        // it was scattered widely
    float width = 0;          // of the ray, for textures
    float spread = 0;
    int bounce = 0;  // surfaces that scattered it
  };
  // A surface with all that is needed to scatter light there.
  struct Vertex {
    Surface surface;
    const Material& material;
    Vec3 color;
    Basis basis;
    Vec3 wo;
  };

  Vec3 follow(State state, std::uint32_t index, Sampler& sampler, PathSample* first);
  Vec3 light_met(const State& state) const;
  Vec3 met(const State& state, std::size_t light, const Vec3& radiance, float light_pdf) const;
  Vec3 sample_lights(const Vertex& vertex, bool all, Sampler& sampler);
  Vec3 sample_light(std::size_t light, float choice, const Vertex& vertex, const Vec2& u) const;
  bool scatter(const Vertex& vertex, const std::array<float, 4>& u, State& state) const;

  const World& world_;
  const RenderSettings& settings_;
  float pixel_angle_;
  LightChoice choice_;
};

}  // namespace vivify::render
