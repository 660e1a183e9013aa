#include "render/image_io.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>

#include "common/error.h"

namespace vivify::render {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& reason) {
  throw Error(ErrorKind::io, "cannot read image " + path.string() + ": " + reason);
}

std::unique_ptr<OIIO::ImageInput> open(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) fail(path, "no such file");
  std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path.string());
  if (!input) {
    const std::string reason = OIIO::geterror();
    fail(path, reason.empty() ? "not an image" : reason);
  }
  return input;
}

// Reads channels [begin, end) of a part as floats, interleaved. OpenImageIO scales integers to [0, 1] on the
// way to float; object numbers (UINT channels) must keep their value, so they are read as what they are.
std::vector<float> read_part(OIIO::ImageInput& input, int part, int begin, int end,
                             const std::filesystem::path& path) {
  const OIIO::ImageSpec spec = input.spec();
  const std::size_t pixels = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height);
  const std::size_t stride = static_cast<std::size_t>(end - begin);
  std::vector<float> values(pixels * stride);
  const auto is_number = [&](int c) { return spec.channelformat(c) == OIIO::TypeDesc::UINT32; };
  for (int first = begin; first < end;) {
    int last = first + 1;  // channels [first, last) are of one kind
    while (last < end && is_number(last) == is_number(first)) ++last;
    const std::size_t run = static_cast<std::size_t>(last - first);
    const auto read = [&](auto type, OIIO::TypeDesc format) {
      std::vector<decltype(type)> block(pixels * run);
      if (!input.read_image(part, 0, first, last, format, block.data())) fail(path, input.geterror());
      for (std::size_t i = 0; i < pixels; ++i) {
        for (std::size_t c = 0; c < run; ++c) {
          values[i * stride + static_cast<std::size_t>(first - begin) + c] =
              static_cast<float>(block[i * run + c]);
        }
      }
    };
    is_number(first) ? read(std::uint32_t{}, OIIO::TypeDesc::UINT32) : read(float{}, OIIO::TypeDesc::FLOAT);
    first = last;
  }
  return values;
}

}  // namespace

Image read_image(const std::filesystem::path& path) {
  const std::unique_ptr<OIIO::ImageInput> input = open(path);
  Image image;
  for (int part = 0; input->seek_subimage(part, 0); ++part) {
    const OIIO::ImageSpec spec = input->spec();
    if (part == 0) {
      image.width = spec.width;
      image.height = spec.height;
      image.display_encoded = spec.format == OIIO::TypeDesc::UINT8 || spec.format == OIIO::TypeDesc::UINT16;
    } else if (spec.width != image.width || spec.height != image.height) {
      fail(path, "its parts have different sizes");
    }
    const std::vector<float> values = read_part(*input, part, 0, spec.nchannels, path);
    const std::size_t before = image.channels.size();
    const std::size_t added = spec.channelnames.size();
    image.channels.insert(image.channels.end(), spec.channelnames.begin(), spec.channelnames.end());
    if (before == 0) {
      image.values = values;
      continue;
    }
    const std::size_t pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    std::vector<float> joined(pixels * (before + added));
    for (std::size_t i = 0; i < pixels; ++i) {
      std::copy_n(&image.values[i * before], before, &joined[i * (before + added)]);
      std::copy_n(&values[i * added], added, &joined[i * (before + added) + before]);
    }
    image.values = std::move(joined);
  }
  if (image.width < 1 || image.height < 1 || image.channels.empty()) fail(path, "it holds no pixels");
  return image;
}

RgbImage read_rgb(const std::filesystem::path& path) {
  const std::unique_ptr<OIIO::ImageInput> input = open(path);
  const OIIO::ImageSpec spec = input->spec();
  std::array<int, 3> channel;
  for (std::size_t c = 0; c < 3; ++c) {
    channel[c] = spec.channelindex(std::string(1, "RGB"[c]));
    if (channel[c] < 0) fail(path, std::string("it has no channel ") + "RGB"[c]);
  }
  const auto [low, high] = std::minmax_element(channel.begin(), channel.end());
  const std::vector<float> values = read_part(*input, 0, *low, *high + 1, path);
  const std::size_t stride = static_cast<std::size_t>(*high - *low + 1);
  RgbImage image{spec.width, spec.height, std::vector<float>(values.size() / stride * 3)};
  for (std::size_t i = 0; i < image.values.size() / 3; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      image.values[3 * i + c] = values[i * stride + static_cast<std::size_t>(channel[c] - *low)];
    }
  }
  return image;
}

Bytes encode_png(int width, int height, std::span<const std::uint8_t> rgb) {
  if (width < 1 || height < 1 ||
      rgb.size() != 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
    throw Error(ErrorKind::internal, "encode_png: the size does not fit the pixels");
  }
  OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  spec.attribute("DateTime", "");  // the same pixels give the same bytes
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create("image.png", &memory);
  if (!output || !output->open("image.png", spec) ||
      !output->write_image(OIIO::TypeDesc::UINT8, rgb.data()) || !output->close()) {
    throw Error(ErrorKind::internal,
                "a PNG image cannot be made: " + (output ? output->geterror() : OIIO::geterror()));
  }
  const std::byte* first = reinterpret_cast<const std::byte*>(bytes.data());
  return Bytes(first, first + bytes.size());
}

}  // namespace vivify::render
