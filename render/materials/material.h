// How a surface scatters light. Directions point away from the surface, in a frame whose z is the shading
// normal (outward, wherever the light comes from).
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

#include "common/schema.h"
#include "common/value.h"
#include "render/textures/texture.h"
#include "render/vec.h"

namespace vivify::render {

// f(wo, wi) |cos θi| and the density (per solid angle) with which sample() takes wi. Delta parts are not
// counted.
struct BsdfValue {
  Vec3 value;
  float pdf = 0;
};

struct BsdfSample {
  Vec3 wi;
  Vec3 weight;         // f |cos θi| / pdf
  float pdf = 0;       // of delta directions: their probability
  bool delta = false;  // mirror or clear refraction: no density
};

// Radiance is carried as basic radiance L/n², so that refraction does not change it and no factor η² appears.
class Material {
 public:
  explicit Material(ColorSource color) : color_(std::move(color)) {}
  virtual ~Material() = default;

  const ColorSource& color() const { return color_; }

  // `color` is color().at(point) in the calls below.
  virtual BsdfValue evaluate(const Vec3& color, const Vec3& wo, const Vec3& wi) const = 0;
  // False: the light is absorbed. `u` is uniform in the unit cube.
  virtual bool sample(const Vec3& color, const Vec3& wo, const Vec3& u, BsdfSample& sample) const = 0;
  // Only delta directions: evaluate() is zero everywhere.
  virtual bool is_delta() const { return false; }
  // f(wo, wi) = f(wi, wo).
  virtual bool is_reciprocal() const { return true; }
  // Radiance that leaves the outer side, the same in all directions.
  virtual Vec3 emission(const Vec3&) const { return {}; }

 private:
  ColorSource color_;
};

// A kind of material. `make` gets the resolved value and the folder where relative paths start.
struct MaterialEntry {
  std::string_view name;
  Schema (*schema)();
  std::unique_ptr<Material> (*make)(const Value& value, const std::filesystem::path& folder);
};

// Every material known; one file and one line each.
std::span<const MaterialEntry> material_registry();

// The material of a value resolved with material_schema().
std::unique_ptr<Material> make_material(const Value& value, const std::filesystem::path& folder);

}  // namespace vivify::render
