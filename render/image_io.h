// Images as plain float arrays: reading EXR and PNG files, PNG files made in memory (OpenImageIO).
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/file.h"

namespace vivify::render {

// All channels of an image file.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::string> channels;  // as named in the file: "R", "albedo.G", "depth.Z"
  std::vector<float> values;          // height by width by #channels, top row first
  bool display_encoded = false;       // 8- or 16-bit integers scaled to [0, 1] (PNG), not linear light

  float at(int x, int y, int channel) const {
    return values[(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                   static_cast<std::size_t>(x)) *
                      channels.size() +
                  static_cast<std::size_t>(channel)];
  }
};

// Reads every channel of every part of an EXR file, or a PNG file. Integer channels of an EXR keep their
// value. Throws Error(io) when the file cannot be read whole, or when its parts have different sizes.
Image read_image(const std::filesystem::path& path);

// The beauty of an image: its channels R, G and B as triples (3 #P values). Throws Error(io) when one of them
// is missing.
struct RgbImage {
  int width = 0;
  int height = 0;
  std::vector<float> values;  // height by width by 3
};
RgbImage read_rgb(const std::filesystem::path& path);

// A PNG file of 8-bit sRGB pixels (height by width by 3); the same pixels give the same bytes.
Bytes encode_png(int width, int height, std::span<const std::uint8_t> rgb);

}  // namespace vivify::render
