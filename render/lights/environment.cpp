// One colour from all around, or a picture of the surroundings.
#include "render/lights/dome.h"
#include "render/textures/texture.h"

namespace vivify::render {

LightEntry environment_light() {
  return {
      "environment",
      [] {
        return with_dome(
            object("Light from all around: one colour, or a picture in latitude and longitude.")
                .field("color", vector("Colour, also a factor on the picture (linear Rec. 709).", 3)
                                    .at_least(0)
                                    .initially({1, 1, 1}))
                .field("strength", number("Factor on the colour.").at_least(0).initially(1))
                .field("file", path("The picture, an image file (EXR, HDR and others); its top is +y and its "
                                    "middle looks to −z.")));
      },
      [](const Value& value, const std::filesystem::path& folder) -> std::unique_ptr<Light> {
        const Vec3 factor = to_vec3(value["color"]) * static_cast<float>(value["strength"].as_number());
        if (!value.has("file")) return make_dome({1, 1, {factor}}, value);
        const Value& file = value["file"];
        Picture picture = read_picture(folder / file.as_string(), "automatic", file.where());
        for (Vec3& texel : picture.texels) {
          texel *= factor;
          texel = {std::max(0.0f, texel.x), std::max(0.0f, texel.y), std::max(0.0f, texel.z)};
        }
        return make_dome(std::move(picture), value);
      }};
}

}  // namespace vivify::render
