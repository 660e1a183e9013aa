// Colours that vary over a surface.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "common/schema.h"
#include "common/value.h"
#include "render/vec.h"

namespace vivify::render {

// A place in texture coordinates and the width that one sample covers there (in the same coordinates).
struct TexturePoint {
  Vec2 uv;
  float width = 0;
};

class Texture {
 public:
  virtual ~Texture() = default;
  virtual Vec3 value(const TexturePoint& point) const = 0;  // linear Rec. 709
};

// A kind of texture. `make` gets the resolved value and the folder where relative paths start.
struct TextureEntry {
  std::string_view name;
  Schema (*schema)();
  std::unique_ptr<Texture> (*make)(const Value& value, const std::filesystem::path& folder);
};
std::span<const TextureEntry> texture_registry();

// A colour that may be multiplied by a texture.
class ColorSource {
 public:
  ColorSource() = default;
  // From the keys `color` and `texture` of a resolved object.
  ColorSource(const Value& value, const std::filesystem::path& folder);
  explicit ColorSource(const Vec3& color) : color_(color) {}

  bool textured() const { return texture_ != nullptr; }
  const Vec3& constant() const { return color_; }  // without the texture
  Vec3 at(const TexturePoint& point) const { return texture_ ? color_ * texture_->value(point) : color_; }

 private:
  Vec3 color_ = Vec3(1);
  std::shared_ptr<const Texture> texture_;
};

// Adds the keys `color` and `texture`, which ColorSource reads.
Schema with_color(Schema&& schema, std::vector<double> color, const char* doc);

// A vector setting as a Vec3.
Vec3 to_vec3(const Value& value);

}  // namespace vivify::render
