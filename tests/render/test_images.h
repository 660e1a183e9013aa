// Images for the tests of image files: made from formulas, written with OpenImageIO.
#pragma once

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "common/rng.h"
#include "render/image_io.h"
#include "tests/common/temporary_folder.h"

namespace vivify::test {

using Folder = testing_support::TemporaryFolder;

// A picture as the renderer makes them: a noisy background at depth 0 and a disc with a smooth albedo in
// front.
inline render::Image test_picture(int width = 64, int height = 36, std::uint64_t seed = 1) {
  render::Image image;
  image.width = width;
  image.height = height;
  image.channels = {"R",        "G",        "B",        "A",        "albedo.R", "albedo.G",
                    "albedo.B", "normal.X", "normal.Y", "normal.Z", "depth.Z",  "id.ID"};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      CounterRng rng(hash_words(seed, static_cast<std::uint64_t>(y), static_cast<std::uint64_t>(x)));
      const double u = (x + 0.5) / height - 0.5 * width / height, v = (y + 0.5) / height - 0.5;
      const double r2 = (u * u + v * v) / 0.16;
      const bool disc = r2 < 1;
      const float nz = disc ? static_cast<float>(std::sqrt(1 - r2)) : 0.0f;
      const float noise = static_cast<float>(rng.uniform(0.7, 1.3));
      const std::vector<float> albedo =
          disc ? std::vector<float>{0.8f, 0.5f + 0.2f * static_cast<float>(u), 0.3f}
               : std::vector<float>{0.2f, 0.2f, 0.25f};
      for (const float a : albedo) image.values.push_back(a * (0.2f + nz) * noise);
      image.values.push_back(1.0f);
      image.values.insert(image.values.end(), albedo.begin(), albedo.end());
      image.values.push_back(disc ? static_cast<float>(u / 0.4) : 0.0f);
      image.values.push_back(disc ? static_cast<float>(-v / 0.4) : 0.0f);
      image.values.push_back(nz);
      image.values.push_back(disc ? 5.0f - nz : 0.0f);
      image.values.push_back(disc ? 7.0f : 0.0f);
    }
  }
  return image;
}

inline int channel_index(const render::Image& image, const std::string& name) {
  for (std::size_t c = 0; c < image.channels.size(); ++c) {
    if (image.channels[c] == name) return static_cast<int>(c);
  }
  ADD_FAILURE() << "no channel " << name;
  return 0;
}

inline float& value(render::Image& image, int x, int y, const std::string& channel) {
  return image.values[(static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                       static_cast<std::size_t>(x)) *
                          image.channels.size() +
                      static_cast<std::size_t>(channel_index(image, channel))];
}

// Writes all channels as 32-bit floats.
inline void write_exr(const std::filesystem::path& path, const render::Image& image) {
  OIIO::ImageSpec spec(image.width, image.height, static_cast<int>(image.channels.size()),
                       OIIO::TypeDesc::FLOAT);
  spec.channelnames = image.channels;
  const auto output = OIIO::ImageOutput::create(path.string());
  ASSERT_TRUE(output && output->open(path.string(), spec) &&
              output->write_image(OIIO::TypeDesc::FLOAT, image.values.data()) && output->close())
      << path;
}

// Writes an EXR of one colour.
inline void write_flat_exr(const std::filesystem::path& path, int width, int height, float red, float green,
                           float blue) {
  render::Image image{width, height, {"R", "G", "B"}, {}, false};
  for (int i = 0; i < width * height; ++i) image.values.insert(image.values.end(), {red, green, blue});
  write_exr(path, image);
}

}  // namespace vivify::test
