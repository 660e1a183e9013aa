#include "render/world.h"

#include <utility>

namespace vivify::render {
namespace {

std::vector<TriangleEmitters::Emitter> shining_triangles(const Geometry& geometry,
                                                         const std::vector<const Material*>& materials) {
  std::vector<TriangleEmitters::Emitter> emitters;
  for (std::uint32_t t = 0; t < geometry.triangles().size(); ++t) {
    const Material& material = *materials[geometry.material(t)];
    const Vec3 radiance = material.emission(material.color().constant());
    if (is_zero(radiance)) continue;
    const auto& corners = geometry.triangles()[t];
    const auto& p = geometry.points();
    emitters.push_back({{p[corners[0]], p[corners[1]], p[corners[2]]}, radiance, t});
  }
  return emitters;
}

}  // namespace

World::World(const std::vector<Mesh>& meshes, const std::map<std::string, std::uint32_t>& material_index,
             std::vector<const Material*> material_list, std::vector<const Material*> blurred_list,
             std::vector<const Light*> light_list)
    : geometry(meshes, material_index),
      accel(geometry.points(), geometry.triangles()),
      materials(std::move(material_list)),
      blurred_materials(std::move(blurred_list)),
      lights(std::move(light_list)),
      emitters(shining_triangles(geometry, materials), geometry.triangles().size()) {}

void LightChoice::update(const World& world, const Vec3& p) {
  const std::size_t count = world.light_count();
  probability_.resize(count);
  float sum = 0;
  int shining = 0;
  for (std::size_t i = 0; i < count; ++i) {
    probability_[i] = world.light(i).importance(p);
    sum += probability_[i];
    if (probability_[i] > 0) ++shining;
  }
  if (shining == 0) return;
  constexpr float kShared = 0.1f;
  for (float& probability : probability_) {
    if (probability > 0)
      probability = (1 - kShared) * probability / sum + kShared / static_cast<float>(shining);
  }
}

int LightChoice::sample(float& u) const {
  float low = 0;
  int last = -1;
  for (std::size_t i = 0; i < probability_.size(); ++i) {
    if (probability_[i] <= 0) continue;
    last = static_cast<int>(i);
    if (u < low + probability_[i]) {
      u = std::min((u - low) / probability_[i], 0x1.fffffep-1f);
      return last;
    }
    low += probability_[i];
  }
  u = 0x1.fffffep-1f;  // the sum of the probabilities was rounded below u
  return last;
}

}  // namespace vivify::render
