// Light from all around, given by a picture of the whole sphere and sampled by its luminance.
#pragma once

#include <functional>

#include "render/lights/light.h"
#include "render/textures/image.h"
#include "render/warp.h"

namespace vivify::render {

class DomeLight : public Light {
 public:
  // `picture` is in latitude and longitude: its top is +y, its middle column looks to −z turned by `heading`
  // (radians) around +y. `compensate`: sample only what is brighter than the mean and leave the rest to the
  // directions of the materials [Karlík et al. 2019]; unbiased only where both are combined (Strategy::mis).
  DomeLight(Picture picture, float heading, bool visible, bool compensate);

  float importance(const Vec3& p) const override;
  bool sample(const Vec3& p, const Vec2& u, LightSample& sample) const override;
  float pdf(const Vec3& p, const Vec3& direction) const override;
  Vec3 radiance(const Ray& ray) const override;

 private:
  Vec3 look_up(const Vec3& direction) const;
  // The square that is sampled: longitude by height y, so that equal areas are equal solid angles.
  Vec2 to_square(const Vec3& direction) const;

  Picture picture_;
  float heading_;
  Distribution2D cells_;
  float irradiance_ = 0;  // luminance of the part that is sampled, on a sphere, times π
};

// A picture of the sphere from its radiance in each direction (unit, turned so that −z is the middle).
Picture picture_of_sphere(int height, const std::function<Vec3(const Vec3&)>& radiance);

// Adds the keys heading_deg, visible and mis_compensation of lights from all around; make_dome reads them.
Schema with_dome(Schema&& schema);
std::unique_ptr<Light> make_dome(Picture picture, const Value& value);

}  // namespace vivify::render
