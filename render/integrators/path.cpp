#include "render/integrators/path.h"

#include "render/warp.h"

namespace vivify::render {
namespace {

using Strategy = RenderSettings::Strategy;

constexpr int kRouletteFrom = 3;         // bounces before paths may end by chance
constexpr float kMattPdf = 1;            // per solid angle; a matt surface has 1/π at most
constexpr std::uint32_t kGroups = 256;   // of the sampler, for each bounce
constexpr float kShadowEnd = 1 - 1e-4f;  // of the way to a light

// Contributions after more than one bounce may be limited; the picture is then a little too dark.
Vec3 limited(const Vec3& c, int bounces, double limit) {
  if (limit <= 0 || bounces <= 1) return c;
  const float y = luminance(c);
  return y > limit ? c * (static_cast<float>(limit) / y) : c;
}

}  // namespace

PathSample PathTracer::trace(const Ray& ray, std::uint32_t index, Sampler& sampler) {
  PathSample result;
  State state;
  state.ray = ray;
  state.origin = ray.origin;
  state.spread = pixel_angle_;
  result.radiance = follow(state, index, sampler, &result);
  return result;
}

// Radiance that comes back along the ray of `state`. Notes the first surface in `first`.
Vec3 PathTracer::follow(State state, std::uint32_t index, Sampler& sampler, PathSample* first) {
  Vec3 sum;
  for (;; ++state.bounce) {
    const Hit hit = world_.accel.intersect(state.ray);
    if (hit) state.ray.tmax = hit.t;
    sum += light_met(state);
    if (!hit) return sum;

    const Surface surface = world_.geometry.surface(hit, state.ray);
    const Material& material = world_.material(hit.triangle, state.matt);
    state.width += state.spread * hit.t;
    TexturePoint texture_point{surface.uv, 0};
    if (material.color().textured()) {
      const float slope = std::max(0.1f, -dot(state.ray.direction, surface.geometric));
      texture_point.width = state.width * surface.uv_scale / std::sqrt(slope);
    }
    const Vec3 color = material.color().at(texture_point);
    if (first != nullptr && state.bounce == 0) {
      first->hit = true;
      first->depth = hit.t;
      first->albedo = color;
      first->normal = surface.shading;
      first->object = world_.geometry.object(hit.triangle);
    }
    if (surface.front) {
      const Vec3 emission = material.emission(color);
      if (!is_zero(emission)) {
        const float cosine = -dot(state.ray.direction, surface.geometric);
        const float distance = length(surface.position - state.origin);
        sum += met(state, world_.lights.size(), emission,
                   world_.emitters.triangle_pdf(hit.triangle, distance, cosine));
      }
    }
    if (state.bounce == settings_.max_depth) return sum;

    const Basis basis(surface.front ? surface.shading : -surface.shading);  // materials see the outer side up
    const Vertex vertex = {surface, material, color, basis, basis.to_local(-state.ray.direction)};
    const std::uint32_t group = kFirstGroup + kGroups * static_cast<std::uint32_t>(state.bounce);

    // From the first rough surface several paths go on.
    if (!state.split && !material.is_delta()) {
      state.split = true;
      const auto splits = static_cast<std::uint32_t>(settings_.splits);
      const float share = 1 / static_cast<float>(splits);
      for (std::uint32_t i = 0; i < splits; ++i) {
        sampler.start(index * splits + i);
        sampler.go_to(group);
        const auto u = sampler.next();
        const Vec3 lit = sample_lights(vertex, true, sampler) * state.throughput;
        sum += limited(lit, state.bounce + 1, settings_.clamp) * share;
        State branch = state;
        branch.all_lights = true;
        if (!scatter(vertex, u, branch)) continue;
        ++branch.bounce;
        sum += follow(branch, index, sampler, nullptr) * share;
      }
      return sum;
    }

    sampler.go_to(group);
    const auto u = sampler.next();
    if (!material.is_delta()) {
      const Vec3 lit = sample_lights(vertex, false, sampler) * state.throughput;
      sum += limited(lit, state.bounce + 1, settings_.clamp);
    }
    state.all_lights = false;
    if (!scatter(vertex, u, state)) return sum;
  }
}

// Light on the way of the ray, up to its end.
Vec3 PathTracer::light_met(const State& state) const {
  Vec3 sum;
  for (std::size_t i = 0; i < world_.lights.size(); ++i) {
    const Light& light = *world_.lights[i];
    if (state.bounce == 0 && !light.visible()) continue;
    const Vec3 radiance = light.radiance(state.ray);
    if (is_zero(radiance)) continue;
    sum += met(state, i, radiance, state.certain ? 0 : light.pdf(state.origin, state.ray.direction));
  }
  return sum;
}

// The share of light that was met by chance and that sampling the light would not have found.
Vec3 PathTracer::met(const State& state, std::size_t light, const Vec3& radiance, float light_pdf) const {
  float weight = 1;
  if (!state.certain) {
    if (settings_.strategy == Strategy::lights_only) return {};
    if (settings_.strategy == Strategy::mis) {
      weight = mis_weight(state.bsdf_pdf, light_pdf * (state.all_lights ? 1.0f : choice_.probability(light)));
    }
  }
  return limited(state.throughput * radiance * weight, state.bounce, settings_.clamp);
}

Vec3 PathTracer::sample_lights(const Vertex& vertex, bool all, Sampler& sampler) {
  if (settings_.strategy == Strategy::bsdf_only) return {};
  Vec3 sum;
  if (all) {
    for (std::size_t i = 0; i < world_.light_count(); ++i) {
      const auto u = sampler.next();
      sum += sample_light(i, 1, vertex, {u[0], u[1]});
    }
    return sum;
  }
  auto u = sampler.next();
  choice_.update(world_, vertex.surface.lifted);
  const int i = choice_.sample(u[2]);
  if (i < 0) return {};
  const auto light = static_cast<std::size_t>(i);
  return sample_light(light, choice_.probability(light), vertex, {u[0], u[1]});
}

Vec3 PathTracer::sample_light(std::size_t i, float choice, const Vertex& vertex, const Vec2& u) const {
  const Surface& surface = vertex.surface;
  LightSample light;
  if (!world_.light(i).sample(surface.lifted, u, light)) return {};
  const Vec3 wi = vertex.basis.to_local(light.direction);
  const BsdfValue f = vertex.material.evaluate(vertex.color, vertex.wo, wi);
  if (is_zero(f.value)) return {};
  // The shading normal must not let light through the surface.
  const bool above = dot(light.direction, surface.geometric) > 0;
  if (above != (wi.z * vertex.wo.z > 0)) return {};
  const float pdf = choice * light.pdf;
  const float weight = settings_.strategy == Strategy::lights_only ? 1.0f : mis_weight(pdf, f.pdf);
  const Vec3 origin = above ? offset_from_surface(surface.lifted, surface.geometric)
                            : offset_from_surface(surface.position, -surface.geometric);
  if (world_.accel.occluded({origin, light.direction, light.distance * kShadowEnd})) return {};
  return f.value * light.radiance * (weight / pdf);
}

// Sends the path on from `vertex`; false: it ends there.
bool PathTracer::scatter(const Vertex& vertex, const std::array<float, 4>& u, State& state) const {
  const Surface& surface = vertex.surface;
  BsdfSample next;
  if (!vertex.material.sample(vertex.color, vertex.wo, {u[0], u[1], u[2]}, next)) return false;
  const Vec3 direction = vertex.basis.to_world(next.wi);
  const bool reflected = next.wi.z * vertex.wo.z > 0;
  if (reflected != (dot(direction, surface.geometric) > 0)) return false;
  state.throughput *= next.weight;
  if (is_zero(state.throughput)) return false;
  if (state.bounce + 1 >= kRouletteFrom) {
    const float stay = std::min(max_component(state.throughput), 0.95f);
    if (u[3] >= stay) return false;
    state.throughput *= 1 / stay;
  }
  state.certain = next.delta;
  state.bsdf_pdf = next.pdf;
  state.origin = surface.lifted;
  state.ray = {reflected ? offset_from_surface(surface.lifted, surface.geometric)
                         : offset_from_surface(surface.position, -surface.geometric),
               direction};
  state.matt = state.matt || (!next.delta && next.pdf < kMattPdf);
  if (!next.delta) state.spread = std::max(state.spread, std::min(0.5f, 0.2f / std::sqrt(next.pdf)));
  return true;
}

}  // namespace vivify::render
