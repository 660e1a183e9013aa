// What shines on the scene. Lights do not block light: a path goes on through them.
#pragma once

#include <filesystem>
#include <limits>
#include <memory>
#include <span>
#include <string_view>

#include "common/schema.h"
#include "common/value.h"
#include "render/accel.h"
#include "render/vec.h"

namespace vivify::render {

struct LightSample {
  Vec3 direction;  // from the lit point, unit length
  float distance = std::numeric_limits<float>::infinity();
  Vec3 radiance;
  float pdf = 0;  // per solid angle
};

class Light {
 public:
  explicit Light(bool visible = true) : visible_(visible) {}
  virtual ~Light() = default;

  // Seen directly by the camera.
  bool visible() const { return visible_; }

  // Rough luminance of the irradiance at p without occlusion, for the choice between lights; 0 only where
  // sample() fails.
  virtual float importance(const Vec3& p) const = 0;

  // A direction from p to the light; false: the light does not shine there.
  virtual bool sample(const Vec3& p, const Vec2& u, LightSample& sample) const = 0;

  // Density of sample() at p for a direction that meets the light.
  virtual float pdf(const Vec3& p, const Vec3& direction) const = 0;

  // Radiance that a ray from outside meets on its way up to tmax (infinity: it leaves the scene).
  virtual Vec3 radiance(const Ray& ray) const = 0;

 private:
  bool visible_;
};

// A kind of light. `make` gets the resolved value and the folder where relative paths start.
struct LightEntry {
  std::string_view name;
  Schema (*schema)();
  std::unique_ptr<Light> (*make)(const Value& value, const std::filesystem::path& folder);
};

// Every light known; one file and one line each.
std::span<const LightEntry> light_registry();

// The light of a value resolved with light_schema(). Throws Error(usage) for one without extent or direction.
std::unique_ptr<Light> make_light(const Value& value, const std::filesystem::path& folder);

// Adds the keys color, radiance and visible of lights with a surface; light_radiance() is the product of the
// first two.
Schema with_radiance(Schema&& schema, double radiance);
Vec3 light_radiance(const Value& value);

// The direction from `position` to `target` of a resolved light. Throws Error(usage) when they are the same.
Vec3 aim(const Value& value);

}  // namespace vivify::render
