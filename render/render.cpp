#include "render/render.h"

#include <atomic>
#include <mutex>
#include <string>
#include <utility>

#include "common/error.h"
#include "common/log.h"
#include "common/parallel.h"
#include "common/rng.h"
#include "common/stop.h"
#include "render/integrators/path.h"
#include "render/lens.h"
#include "render/warp.h"
#include "render/world.h"

namespace vivify::render {
namespace {

constexpr int kTile = 16;  // pixels per side

// Renders one pixel. Returns the number of samples that were not finite and count as black.
int render_pixel(int x, int y, const Lens& lens, PathTracer& tracer, const RenderSettings& settings,
                 std::uint64_t frame_seed, Film& film) {
  const std::size_t pixel =
      static_cast<std::size_t>(y) * static_cast<std::size_t>(film.width) + static_cast<std::size_t>(x);
  Sampler sampler(hash_words(frame_seed, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)),
                  static_cast<std::uint32_t>(settings.spp) * static_cast<std::uint32_t>(settings.splits));
  Vec3 radiance, albedo, normal;
  float depth = 0;
  int hits = 0, lost = 0, object = 0;
  float nearest = std::numeric_limits<float>::infinity();
  for (int s = 0; s < settings.spp; ++s) {
    sampler.start(static_cast<std::uint32_t>(s));
    const auto u = sampler.next();
    // The filter is a tent of radius 1 pixel, by importance: each pixel owns its sum.
    const float dx = sample_tent(u[0]);
    const float dy = sample_tent(u[1]);
    const Ray ray =
        lens.ray({static_cast<float>(x) + 0.5f + dx, static_cast<float>(y) + 0.5f + dy}, {u[2], u[3]});
    const PathSample path = tracer.trace(ray, static_cast<std::uint32_t>(s), sampler);
    if (is_finite(path.radiance))
      radiance += path.radiance;
    else
      ++lost;
    albedo += path.albedo;
    normal += path.normal;
    depth += path.depth;
    hits += path.hit ? 1 : 0;
    const float off = dx * dx + dy * dy;
    if (off < nearest) {
      nearest = off;
      object = path.object;
    }
  }
  const float share = 1 / static_cast<float>(settings.spp);
  const auto put = [&](std::vector<float>& plane, std::size_t stride, const Vec3& v) {
    plane[stride * pixel] = v.x;
    plane[stride * pixel + 1] = v.y;
    plane[stride * pixel + 2] = v.z;
  };
  put(film.rgba, 4, radiance * share);
  film.rgba[4 * pixel + 3] = static_cast<float>(hits) * share;
  put(film.albedo, 3, albedo * share);
  put(film.normal, 3, normal * share);
  film.depth[pixel] = hits > 0 ? depth / static_cast<float>(hits) : 0;
  film.id[pixel] = static_cast<float>(object);
  return lost;
}

}  // namespace

struct Renderer::State {
  std::vector<std::unique_ptr<Material>> materials;
  std::map<std::string, std::uint32_t> material_index;
  std::vector<std::unique_ptr<Light>> lights;
  Looks looks;
  // Materials of a least roughness, made when first asked for.
  std::map<double, std::vector<std::unique_ptr<Material>>> blurred;
  std::mutex blurred_mutex;

  std::vector<const Material*> blurred_materials(double roughness);
};

std::vector<const Material*> Renderer::State::blurred_materials(double roughness) {
  const std::lock_guard lock(blurred_mutex);
  auto& made = blurred[roughness];
  std::vector<const Material*> list;
  std::size_t i = 0;
  for (const auto& [name, value] : looks.materials) {
    const bool sharp = value.has("roughness") && value["roughness"].as_number() < roughness;
    if (made.size() <= i) {
      made.emplace_back();
      if (sharp) {
        Value rough = value;
        rough.set("roughness", Value::number(roughness));
        made.back() = make_material(rough, looks.folder);
      }
    }
    list.push_back(sharp ? made[i].get() : materials[i].get());
    ++i;
  }
  return list;
}

Renderer::Renderer(const Looks& looks) : state_(std::make_unique<State>()) {
  state_->looks = looks;
  for (const auto& [name, value] : looks.materials) {
    state_->material_index[name] = static_cast<std::uint32_t>(state_->materials.size());
    state_->materials.push_back(make_material(value, looks.folder));
  }
  for (const Value& value : looks.lights) state_->lights.push_back(make_light(value, looks.folder));
}

Renderer::~Renderer() = default;

Film Renderer::render(const Frame& frame, const RenderSettings& settings,
                      const std::function<void(double)>& progress) const {
  std::vector<const Material*> materials;
  for (const auto& material : state_->materials) materials.push_back(material.get());
  std::vector<const Light*> lights;
  for (const auto& light : state_->lights) lights.push_back(light.get());
  const World world(frame.meshes, state_->material_index, std::move(materials),
                    state_->blurred_materials(settings.indirect_roughness), std::move(lights));
  const Lens lens(frame.camera, settings.width, settings.height);
  const std::uint64_t frame_seed = hash_words(settings.seed, static_cast<std::uint64_t>(frame.number));

  Film film(settings.width, settings.height);
  const int columns = (settings.width + kTile - 1) / kTile;
  const int rows = (settings.height + kTile - 1) / kTile;
  const auto tiles = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  std::atomic<int> lost = 0;
  std::mutex progress_mutex;
  std::size_t done = 0;
  parallel_for(tiles, [&](std::size_t tile) {
    check_stop();
    const FlushDenormals flush;
    PathTracer tracer(world, settings, lens.pixel_angle());
    const int x0 = static_cast<int>(tile % static_cast<std::size_t>(columns)) * kTile;
    const int y0 = static_cast<int>(tile / static_cast<std::size_t>(columns)) * kTile;
    for (int y = y0; y < std::min(y0 + kTile, settings.height); ++y) {
      for (int x = x0; x < std::min(x0 + kTile, settings.width); ++x) {
        lost += render_pixel(x, y, lens, tracer, settings, frame_seed, film);
      }
    }
    if (progress) {
      const std::lock_guard lock(progress_mutex);
      progress(static_cast<double>(++done) / static_cast<double>(tiles));
    }
  });
  if (lost > 0) {
    log_warning("frame " + std::to_string(frame.number) + ": " + std::to_string(lost) +
                " samples were not finite and count as black");
  }
  return film;
}

}  // namespace vivify::render
