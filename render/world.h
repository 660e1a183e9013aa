// Everything a path meets: the geometry of a frame with its materials, and the lights.
#pragma once

#include <memory>
#include <vector>

#include "render/accel.h"
#include "render/geometry.h"
#include "render/lights/emitters.h"
#include "render/lights/light.h"
#include "render/materials/material.h"

namespace vivify::render {

struct World {
  Geometry geometry;
  Accel accel;
  std::vector<const Material*> materials;          // by index of the geometry
  std::vector<const Material*> blurred_materials;  // the same, for light on its way to a matt surface
  std::vector<const Light*> lights;
  TriangleEmitters emitters;

  World(const std::vector<Mesh>& meshes, const std::map<std::string, std::uint32_t>& material_index,
        std::vector<const Material*> material_list, std::vector<const Material*> blurred_list,
        std::vector<const Light*> light_list);

  std::size_t light_count() const { return lights.size() + (emitters.empty() ? 0 : 1); }
  const Light& light(std::size_t i) const { return i < lights.size() ? *lights[i] : emitters; }
  const Material& material(std::uint32_t triangle, bool blurred) const {
    return *(blurred ? blurred_materials : materials)[geometry.material(triangle)];
  }
};

// Probabilities of choosing each light at a point, in proportion to its importance there, with a little for
// all that can shine there.
class LightChoice {
 public:
  void update(const World& world, const Vec3& p);
  // The light that u falls into; u becomes its place in there. −1: no light shines at the point.
  int sample(float& u) const;
  float probability(std::size_t light) const { return probability_[light]; }

 private:
  std::vector<float> probability_;
};

}  // namespace vivify::render
