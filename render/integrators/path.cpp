#include "render/integrators/path.h"

#include "render/warp.h"

namespace vivify::render {
namespace {

using Strategy = RenderSettings::Strategy;

constexpr int kRouletteFrom = 3;         // bounces before paths may end by chance
constexpr float kShadowEnd = 1 - 1e-4f;  // of the way to a light

// Contributions after more than one bounce may be limited; the picture is then a little too dark.
Vec3 limited(const Vec3& c, int bounces, double limit) {
  if (limit <= 0 || bounces <= 1) return c;
  const float y = luminance(c);
  return y > limit ? c * (static_cast<float>(limit) / y) : c;
}

}  // namespace

Vec3 PathTracer::sample_light(std::size_t i, float choice, const Surface& surface, const Basis& basis,
                              const Vec3& wo, const Material& material, const Vec3& color,
                              const Vec2& u) const {
  LightSample light;
  if (!world_.light(i).sample(surface.lifted, u, light)) return {};
  const Vec3 wi = basis.to_local(light.direction);
  const BsdfValue f = material.evaluate(color, wo, wi);
  if (is_zero(f.value)) return {};
  // The shading normal must not let light through the surface.
  const bool above = dot(light.direction, surface.geometric) > 0;
  if (above != (wi.z * wo.z > 0)) return {};
  const float pdf = choice * light.pdf;
  const float weight = settings_.strategy == Strategy::lights_only ? 1.0f : mis_weight(pdf, f.pdf);
  const Vec3 origin = above ? offset_from_surface(surface.lifted, surface.geometric)
                            : offset_from_surface(surface.position, -surface.geometric);
  if (world_.accel.occluded({origin, light.direction, light.distance * kShadowEnd})) return {};
  return f.value * light.radiance * (weight / pdf);
}

PathSample PathTracer::trace(Ray ray, Sampler& sampler) {
  PathSample result;
  Vec3 throughput(1);
  Vec3 origin = ray.origin;  // the point that lights are sampled from, for MIS
  float bsdf_pdf = 0;        // of the ray
  bool certain = true;       // camera or delta: lights could not have been sampled
  bool all_lights = false;   // at the ray's origin each light was sampled, not one of them
  float width = 0;           // of the ray, for textures
  float spread = pixel_angle_;

  for (int bounce = 0;; ++bounce) {
    const Hit hit = world_.accel.intersect(ray);
    if (hit) ray.tmax = hit.t;

    // Light met on the way.
    const auto met = [&](std::size_t i, const Vec3& radiance, float light_pdf) {
      float weight = 1;
      if (!certain) {
        if (settings_.strategy == Strategy::lights_only) return;
        if (settings_.strategy == Strategy::mis) {
          weight = mis_weight(bsdf_pdf, light_pdf * (all_lights ? 1.0f : choice_.probability(i)));
        }
      }
      result.radiance += limited(throughput * radiance * weight, bounce, settings_.clamp);
    };
    for (std::size_t i = 0; i < world_.lights.size(); ++i) {
      const Light& light = *world_.lights[i];
      if (bounce == 0 && !light.visible()) continue;
      const Vec3 radiance = light.radiance(ray);
      if (!is_zero(radiance)) met(i, radiance, certain ? 0 : light.pdf(origin, ray.direction));
    }
    if (!hit) break;

    const Surface surface = world_.geometry.surface(hit, ray);
    const Material& material = world_.material(hit.triangle);
    width += spread * hit.t;
    TexturePoint texture_point{surface.uv, 0};
    if (material.color().textured()) {
      const float slope = std::max(0.1f, -dot(ray.direction, surface.geometric));
      texture_point.width = width * surface.uv_scale / std::sqrt(slope);
    }
    const Vec3 color = material.color().at(texture_point);
    if (bounce == 0) {
      result.hit = true;
      result.depth = hit.t;
      result.albedo = color;
      result.normal = surface.shading;
      result.object = world_.geometry.object(hit.triangle);
    }
    if (surface.front) {
      const Vec3 emission = material.emission(color);
      if (!is_zero(emission)) {
        const float cosine = -dot(ray.direction, surface.geometric);
        const float distance = length(surface.position - origin);
        met(world_.lights.size(), emission, world_.emitters.triangle_pdf(hit.triangle, distance, cosine));
      }
    }
    if (bounce == settings_.max_depth) break;

    // Materials see the outer side up.
    const Basis basis(surface.front ? surface.shading : -surface.shading);
    const Vec3 wo = basis.to_local(-ray.direction);

    sampler.go_to(kFirstGroup + 64u * static_cast<std::uint32_t>(bounce));
    const auto u = sampler.next();
    const bool lights_help = !material.is_delta() && settings_.strategy != Strategy::bsdf_only;
    if (lights_help) {
      Vec3 sum;
      all_lights = bounce == 0;
      if (all_lights) {
        for (std::size_t i = 0; i < world_.light_count(); ++i) {
          const auto v = sampler.next();
          sum += sample_light(i, 1, surface, basis, wo, material, color, {v[0], v[1]});
        }
      } else {
        auto v = sampler.next();
        choice_.update(world_, surface.lifted);
        const int i = choice_.sample(v[2]);
        if (i >= 0) {
          const auto light = static_cast<std::size_t>(i);
          sum = sample_light(light, choice_.probability(light), surface, basis, wo, material, color,
                             {v[0], v[1]});
        }
      }
      result.radiance += limited(throughput * sum, bounce + 1, settings_.clamp);
    }

    BsdfSample next;
    if (!material.sample(color, wo, {u[0], u[1], u[2]}, next)) break;
    const Vec3 direction = basis.to_world(next.wi);
    const bool reflected = next.wi.z * wo.z > 0;
    if (reflected != (dot(direction, surface.geometric) > 0)) break;
    throughput *= next.weight;
    if (is_zero(throughput)) break;
    if (bounce + 1 >= kRouletteFrom) {
      const float stay = std::min(max_component(throughput), 0.95f);
      if (u[3] >= stay) break;
      throughput *= 1 / stay;
    }
    certain = next.delta;
    bsdf_pdf = next.pdf;
    origin = surface.lifted;
    ray = {reflected ? offset_from_surface(surface.lifted, surface.geometric)
                     : offset_from_surface(surface.position, -surface.geometric),
           direction};
    if (!next.delta) spread = std::max(spread, std::min(0.5f, 0.2f / std::sqrt(next.pdf)));
  }
  return result;
}

}  // namespace vivify::render
