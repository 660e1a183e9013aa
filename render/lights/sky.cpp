// A plain sky: one colour overhead, one at the horizon, one for the ground.
#include "render/lights/dome.h"
#include "render/textures/texture.h"

namespace vivify::render {

LightEntry sky_light() {
  return {
      "sky",
      [] {
        return with_dome(
            object("A plain sky that fades from the zenith to the horizon, above a ground of one colour.")
                .field(
                    "zenith",
                    vector("Radiance overhead (linear Rec. 709).", 3).at_least(0).initially({0.35, 0.5, 0.8}))
                .field("horizon",
                       vector("Radiance at the horizon.", 3).at_least(0).initially({0.9, 0.9, 0.9}))
                .field("ground", vector("Radiance from below.", 3).at_least(0).initially({0.25, 0.22, 0.2}))
                .field("strength", number("Factor on the colours.").at_least(0).initially(1)));
      },
      [](const Value& value, const std::filesystem::path&) -> std::unique_ptr<Light> {
        const auto strength = static_cast<float>(value["strength"].as_number());
        const Vec3 zenith = to_vec3(value["zenith"]) * strength;
        const Vec3 horizon = to_vec3(value["horizon"]) * strength;
        const Vec3 ground = to_vec3(value["ground"]) * strength;
        return make_dome(picture_of_sphere(128,
                                           [&](const Vec3& d) {
                                             if (d.y < 0) {
                                               const float share = std::min(1.0f, -d.y / 0.1f);
                                               return horizon * (1 - share) + ground * share;
                                             }
                                             const float share = std::sqrt(d.y);
                                             return horizon * (1 - share) + zenith * share;
                                           }),
                         value);
      }};
}

}  // namespace vivify::render
