// Checkerboard, averaged over the width of the sample.
#include "render/textures/texture.h"

namespace vivify::render {
namespace {

class Checker : public Texture {
 public:
  explicit Checker(const Value& value)
      : even_(to_vec3(value["even"])),
        odd_(to_vec3(value["odd"])),
        scale_(static_cast<float>(value["scale"].as_number())) {}

  Vec3 value(const TexturePoint& point) const override {
    const float width = std::max(point.width * scale_, 1e-3f);
    // ±1 stripes in each direction, box-filtered; their product is the board.
    const float sign = stripes(point.uv.x * scale_, width) * stripes(point.uv.y * scale_, width);
    return even_ * (0.5f + 0.5f * sign) + odd_ * (0.5f - 0.5f * sign);
  }

 private:
  // Mean over [x − w/2, x + w/2] of the square wave that is 1 on [0, 1) and −1 on [1, 2).
  static float stripes(float x, float w) {
    const auto triangle = [](float s) {  // integral of the wave
      const float r = s - 2 * std::floor(0.5f * s);
      return r < 1 ? r : 2 - r;
    };
    return (triangle(x + 0.5f * w) - triangle(x - 0.5f * w)) / w;
  }

  Vec3 even_, odd_;
  float scale_;
};

}  // namespace

TextureEntry checker_texture() {
  return {"checker",
          [] {
            return object("A checkerboard in texture coordinates.")
                .field("even", vector("Colour of the fields whose two numbers add up to an even one.", 3)
                                   .at_least(0)
                                   .initially({1, 1, 1}))
                .field("odd", vector("Colour of the other fields.", 3).at_least(0).initially({0.2, 0.2, 0.2}))
                .field("scale", number("Fields per unit of the texture coordinates.").above(0).initially(8));
          },
          [](const Value& value, const std::filesystem::path&) -> std::unique_ptr<Texture> {
            return std::make_unique<Checker>(value);
          }};
}

}  // namespace vivify::render
