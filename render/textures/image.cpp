#include "render/textures/image.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <utility>

#include "common/gltf_file.h"
#include "render/textures/texture.h"

namespace vivify::render {

float srgb_to_linear(float v) { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); }

namespace {

Bytes image_inside(const std::filesystem::path& file, long number, const Location& where) {
  try {
    return read_embedded_image(file, number);
  } catch (const Error& error) {
    throw Error(ErrorKind::io, error.what(), error.hint(), where);
  }
}

// The ending of the name tells the format.
const char* name_of(const Bytes& image) {
  return !image.empty() && image.front() == std::byte{0x89} ? "image.png" : "image.jpg";
}

}  // namespace

Picture read_picture(const std::filesystem::path& file, const std::string& colorspace, const Location& where,
                     std::optional<long> embedded) {
  const auto fail = [&](const std::string& reason) {
    return Error(ErrorKind::io, "the image '" + file.string() + "' cannot be read: " + reason, "", where);
  };
  const Bytes content = embedded ? image_inside(file, *embedded, where) : Bytes();
  OIIO::Filesystem::IOMemReader memory(content.data(), content.size());
  const std::unique_ptr<OIIO::ImageInput> input =
      embedded ? OIIO::ImageInput::open(name_of(content), nullptr, &memory)
               : OIIO::ImageInput::open(file.string());
  if (!input) throw fail(OIIO::geterror());
  const OIIO::ImageSpec& spec = input->spec();
  const int channels = spec.nchannels >= 3 ? 3 : 1;
  if (spec.width <= 0 || spec.height <= 0 || spec.nchannels < 1) throw fail("it has no pixels");
  const bool integers = !spec.format.is_floating_point();
  Picture picture{spec.width, spec.height, {}};
  const std::size_t count = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height);
  std::vector<float> values(count * static_cast<std::size_t>(channels));
  if (!input->read_image(0, 0, 0, channels, OIIO::TypeDesc::FLOAT, values.data()))
    throw fail(input->geterror());
  const bool decode = colorspace == "srgb" || (colorspace == "automatic" && integers);
  picture.texels.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    float c[3];
    for (int k = 0; k < 3; ++k) {
      const float v =
          values[i * static_cast<std::size_t>(channels) + static_cast<std::size_t>(channels == 3 ? k : 0)];
      if (!std::isfinite(v)) throw fail("a pixel is not a finite number");
      c[k] = decode ? srgb_to_linear(v) : v;
    }
    picture.texels.push_back({c[0], c[1], c[2]});
  }
  return picture;
}

Vec3 bilinear(const Picture& picture, const Vec2& uv, bool hold_rows) {
  const float x = (uv.x - std::floor(uv.x)) * static_cast<float>(picture.width) - 0.5f;
  const float v = hold_rows ? std::clamp(1 - uv.y, 0.0f, 1.0f) : 1 - (uv.y - std::floor(uv.y));
  const float y = v * static_cast<float>(picture.height) - 0.5f;
  const float fx = std::floor(x);
  const float fy = std::floor(y);
  const auto wrap = [](int i, int n) { return i < 0 ? i + n : i >= n ? i - n : i; };
  const auto hold = [](int i, int n) { return std::clamp(i, 0, n - 1); };
  const int x0 = wrap(static_cast<int>(fx), picture.width);
  const int x1 = wrap(static_cast<int>(fx) + 1, picture.width);
  const int y0 = static_cast<int>(fy);
  const int top = hold_rows ? hold(y0, picture.height) : wrap(y0, picture.height);
  const int bottom = hold_rows ? hold(y0 + 1, picture.height) : wrap(y0 + 1, picture.height);
  const float a = x - fx;
  const float b = y - fy;
  return (picture.at(x0, top) * (1 - a) + picture.at(x1, top) * a) * (1 - b) +
         (picture.at(x0, bottom) * (1 - a) + picture.at(x1, bottom) * a) * b;
}

std::vector<Picture> mip_levels(Picture picture) {
  std::vector<Picture> levels;
  levels.push_back(std::move(picture));
  while (levels.back().width > 1 || levels.back().height > 1) {
    const Picture& fine = levels.back();
    Picture coarse{std::max(1, fine.width / 2), std::max(1, fine.height / 2), {}};
    for (int y = 0; y < coarse.height; ++y) {
      for (int x = 0; x < coarse.width; ++x) {
        const int x_end = x + 1 == coarse.width ? fine.width : 2 * x + 2;
        const int y_end = y + 1 == coarse.height ? fine.height : 2 * y + 2;
        Vec3 sum;
        for (int j = 2 * y; j < y_end; ++j) {
          for (int i = 2 * x; i < x_end; ++i) sum += fine.at(i, j);
        }
        coarse.texels.push_back(sum / static_cast<float>((x_end - 2 * x) * (y_end - 2 * y)));
      }
    }
    levels.push_back(std::move(coarse));
  }
  return levels;
}

namespace {

class ImageTexture : public Texture {
 public:
  ImageTexture(const Value& value, const std::filesystem::path& folder)
      : levels_(mip_levels(read_picture(
            folder / value["file"].as_string(), value["colorspace"].as_string(), value["file"].where(),
            value.has("image") ? std::optional(value["image"].as_integer()) : std::nullopt))),
        scale_(static_cast<float>(value["scale"].as_number())) {}

  Vec3 value(const TexturePoint& point) const override {
    const Vec2 uv = {point.uv.x * scale_, point.uv.y * scale_};
    const float texels =
        point.width * scale_ * static_cast<float>(std::max(levels_[0].width, levels_[0].height));
    const float level = std::log2(std::max(texels, 1.0f));
    const auto last = static_cast<float>(levels_.size() - 1);
    if (level >= last) return levels_.back().texels[0];
    const auto lower = static_cast<std::size_t>(level);
    const float share = level - static_cast<float>(lower);
    const Vec3 fine = bilinear(levels_[lower], uv, false);
    if (share == 0) return fine;
    return fine * (1 - share) + bilinear(levels_[lower + 1], uv, false) * share;
  }

 private:
  std::vector<Picture> levels_;
  float scale_;
};

}  // namespace

TextureEntry image_texture() {
  return {
      "image",
      [] {
        return object("An image file, repeated in both directions.")
            .field("file", path("The image file (PNG, JPEG, EXR, TIFF and others).").required())
            .field(
                "image",
                integer("The file is a GLB file, and this is the number of the image inside it.").at_least(0))
            .field("scale", number("How often the image is repeated per unit of the texture coordinates.")
                                .above(0)
                                .initially(1))
            .field("colorspace",
                   choice("How the values are encoded. `automatic`: files of integers are sRGB.",
                          {"automatic", "srgb", "linear"})
                       .initially("automatic"));
      },
      [](const Value& value, const std::filesystem::path& folder) -> std::unique_ptr<Texture> {
        return std::make_unique<ImageTexture>(value, folder);
      }};
}

}  // namespace vivify::render
