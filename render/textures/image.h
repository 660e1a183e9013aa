// A picture in memory and its look-up, for textures and environments.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/error.h"
#include "render/vec.h"

namespace vivify::render {

struct Picture {
  int width = 0;
  int height = 0;
  std::vector<Vec3> texels;  // rows from top to bottom, linear

  const Vec3& at(int x, int y) const {
    return texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
};

// Reads the first three channels (or the one) of an image file. `colorspace` is linear, srgb or automatic
// (files of integers are sRGB); `embedded` is the number of an image inside a GLB file. Throws Error(io) with
// `where` when it cannot be read whole.
Picture read_picture(const std::filesystem::path& file, const std::string& colorspace, const Location& where,
                     std::optional<long> embedded = {});

// sRGB curve to linear light, for values in [0, 1] and beyond.
float srgb_to_linear(float v);

// Bilinear look-up; (0, 0) is the lower left corner of the picture and (1, 1) the upper right. Repeats in x;
// repeats in y, or holds the border rows when `hold_rows`.
Vec3 bilinear(const Picture& picture, const Vec2& uv, bool hold_rows);

// The pictures of half the size each, down to one texel; the first is the picture itself. Averages of 2 by 2
// texels (3 where the size is odd).
std::vector<Picture> mip_levels(Picture picture);

}  // namespace vivify::render
