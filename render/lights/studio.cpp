// A photo studio: a bright soft box, a weaker one on the other side, and a dim room.
#include "render/lights/dome.h"
#include "render/textures/texture.h"

namespace vivify::render {
namespace {

constexpr float kDegree = kPi / 180;

// A rounded rectangle with soft edges in the directions around `axis`; 1 inside, 0 outside.
float soft_box(const Vec3& direction, float azimuth, float elevation, float half_width, float half_height) {
  const Vec3 axis = {std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                     -std::cos(elevation) * std::cos(azimuth)};
  const float depth = dot(direction, axis);
  if (depth <= 0) return 0;
  const Vec3 side = {std::cos(azimuth), 0, std::sin(azimuth)};
  const Vec3 rise = cross(side, axis);
  const float x = std::max(0.0f, std::abs(dot(direction, side) / depth) - 0.7f * half_width);
  const float y = std::max(0.0f, std::abs(dot(direction, rise) / depth) - 0.7f * half_height);
  const float corner = 0.3f * std::min(half_width, half_height);
  const float edge = std::clamp(1 - (std::sqrt(x * x + y * y) - corner) / (0.5f * corner), 0.0f, 1.0f);
  return edge * edge * (3 - 2 * edge);
}

}  // namespace

LightEntry studio_light() {
  return {"studio",
          [] {
            return with_dome(
                object("A photo studio: a large soft box overhead to the left, a weaker one to the right, a "
                       "dim room.")
                    .field("color", vector("Colour of the boxes (linear Rec. 709).", 3)
                                        .at_least(0)
                                        .initially({1, 0.97, 0.92}))
                    .field("key",
                           number("Radiance of the large box.").unit("W/(m² sr)").at_least(0).initially(12))
                    .field("fill",
                           number("Radiance of the weaker box.").unit("W/(m² sr)").at_least(0).initially(3))
                    .field("room", vector("Radiance of the room (linear Rec. 709).", 3)
                                       .at_least(0)
                                       .initially({0.3, 0.32, 0.36})));
          },
          [](const Value& value, const std::filesystem::path&) -> std::unique_ptr<Light> {
            const Vec3 color = to_vec3(value["color"]);
            const Vec3 key = color * static_cast<float>(value["key"].as_number());
            const Vec3 fill = color * static_cast<float>(value["fill"].as_number());
            const Vec3 room = to_vec3(value["room"]);
            return make_dome(
                picture_of_sphere(256,
                                  [&](const Vec3& d) {
                                    return room * (0.75f + 0.25f * d.y) +
                                           key * soft_box(d, -50 * kDegree, 55 * kDegree, 0.6f, 0.45f) +
                                           fill * soft_box(d, 75 * kDegree, 30 * kDegree, 0.3f, 0.6f);
                                  }),
                value);
          }};
}

}  // namespace vivify::render
