#include "render/image_io.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.h"
#include "render/film.h"
#include "tests/render/test_images.h"

namespace vivify::render {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// The message of the Error(io) that `work` throws.
template <class Work>
std::string io_error(Work work) {
  try {
    work();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::io);
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

TEST(ImageIo, PngComesBackAsItWas) {
  const test::Folder folder;
  std::vector<std::uint8_t> pixels;
  for (int i = 0; i < 3 * 7 * 5; ++i) pixels.push_back(static_cast<std::uint8_t>((i * 53) % 256));
  const Bytes file = encode_png(7, 5, pixels);
  EXPECT_EQ(file, encode_png(7, 5, pixels));
  write_file_atomic(folder / "a.png", file);
  const Image image = read_image(folder / "a.png");
  EXPECT_EQ(image.width, 7);
  EXPECT_EQ(image.height, 5);
  EXPECT_TRUE(image.display_encoded);
  EXPECT_THAT(image.channels, ElementsAre("R", "G", "B"));
  ASSERT_EQ(image.values.size(), pixels.size());
  for (std::size_t i = 0; i < pixels.size(); ++i)
    EXPECT_EQ(std::lround(255 * image.values[i]), pixels[i]) << i;
}

TEST(ImageIo, PngHoldsNoTime) {
  const Bytes file = encode_png(2, 2, std::vector<std::uint8_t>(12, 9));
  const std::string text(reinterpret_cast<const char*>(file.data()), file.size());
  for (const char* word : {"tIME", "DateTime", "Creation"})
    EXPECT_EQ(text.find(word), std::string::npos) << word;
}

TEST(ImageIo, ExrKeepsEveryChannelAndEveryBit) {
  const test::Folder folder;
  const Image picture = test::test_picture(19, 11);
  test::write_exr(folder / "a.exr", picture);
  const Image read = read_image(folder / "a.exr");
  EXPECT_EQ(read.width, 19);
  EXPECT_EQ(read.height, 11);
  EXPECT_FALSE(read.display_encoded);
  EXPECT_THAT(read.channels, testing::UnorderedElementsAreArray(picture.channels));
  for (const std::string& name : picture.channels) {
    const int a = test::channel_index(picture, name), b = test::channel_index(read, name);
    for (int y = 0; y < 11; ++y) {
      for (int x = 0; x < 19; ++x)
        ASSERT_EQ(picture.at(x, y, a), read.at(x, y, b)) << name << " " << x << " " << y;
    }
  }
}

TEST(ImageIo, MixedTypesKeepTheirValues) {
  const test::Folder folder;
  OIIO::ImageSpec spec(3, 2, 5, OIIO::TypeDesc::FLOAT);
  spec.channelnames = {"R", "G", "B", "depth.Z", "id.ID"};
  spec.channelformats = {OIIO::TypeDesc::HALF, OIIO::TypeDesc::HALF, OIIO::TypeDesc::HALF,
                         OIIO::TypeDesc::FLOAT, OIIO::TypeDesc::UINT32};
  struct [[gnu::packed]] Pixel {
    std::array<std::uint16_t, 3> rgb;
    float depth;
    std::uint32_t id;
  };
  std::vector<Pixel> pixels(6, {{0x3800, 0x3c00, 0x4000}, 1.1f, 0});  // halves 0.5, 1, 2
  for (std::uint32_t i = 0; i < 6; ++i) pixels[i].id = 70000 + i;
  const auto output = OIIO::ImageOutput::create("a.exr");
  ASSERT_TRUE(output->open((folder / "a.exr").string(), spec));
  ASSERT_TRUE(output->write_image(OIIO::TypeDesc::UNKNOWN, pixels.data()) && output->close());

  const Image image = read_image(folder / "a.exr");
  const auto at = [&](int x, int y, const char* name) {
    return image.at(x, y, test::channel_index(image, name));
  };
  EXPECT_EQ(at(1, 0, "R"), 0.5f);
  EXPECT_EQ(at(1, 0, "B"), 2.0f);
  EXPECT_EQ(at(2, 1, "depth.Z"), 1.1f);
  EXPECT_EQ(at(0, 0, "id.ID"), 70000.0f);
  EXPECT_EQ(at(2, 1, "id.ID"), 70005.0f);
  EXPECT_THAT(read_rgb(folder / "a.exr").values, testing::SizeIs(18));
  EXPECT_EQ(read_rgb(folder / "a.exr").values[4], 1.0f);
}

TEST(ImageIo, RgbIsPickedOutOfManyChannels) {
  const test::Folder folder;
  Image picture = test::test_picture(9, 6);
  test::write_exr(folder / "a.exr", picture);
  const RgbImage rgb = read_rgb(folder / "a.exr");
  ASSERT_EQ(rgb.values.size(), 3u * 9 * 6);
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 9; ++x) {
      const std::size_t i = static_cast<std::size_t>(3 * (y * 9 + x));
      EXPECT_EQ(rgb.values[i], test::value(picture, x, y, "R"));
      EXPECT_EQ(rgb.values[i + 1], test::value(picture, x, y, "G"));
      EXPECT_EQ(rgb.values[i + 2], test::value(picture, x, y, "B"));
    }
  }
}

TEST(ImageIo, PicturesOfTheRendererAreRead) {
  const test::Folder folder;
  Film film(5, 4);
  for (std::size_t i = 0; i < film.pixels(); ++i) {
    film.rgba[4 * i + 1] = static_cast<float>(i) / 4;
    film.normal[3 * i + 2] = 0.1f * static_cast<float>(i);
    film.depth[i] = 1.1f * static_cast<float>(i);
    film.id[i] = static_cast<float>(i % 3);
  }
  write_file_atomic(folder / "a.exr", encode_exr(film));
  const Image image = read_image(folder / "a.exr");
  const RgbImage rgb = read_rgb(folder / "a.exr");
  EXPECT_EQ(image.width, 5);
  EXPECT_EQ(image.height, 4);
  for (std::size_t i = 0; i < film.pixels(); ++i) {
    const int x = static_cast<int>(i) % 5, y = static_cast<int>(i) / 5;
    const auto at = [&](const char* name) { return image.at(x, y, test::channel_index(image, name)); };
    EXPECT_EQ(at("G"), film.rgba[4 * i + 1]);
    EXPECT_EQ(at("normal.Z"), film.normal[3 * i + 2]);
    EXPECT_EQ(at("depth.Z"), film.depth[i]);
    EXPECT_EQ(at("id.ID"), film.id[i]);
    EXPECT_EQ(rgb.values[3 * i + 1], film.rgba[4 * i + 1]);
  }
}

TEST(ImageIo, PartsAreJoined) {
  const test::Folder folder;
  std::vector<OIIO::ImageSpec> specs{OIIO::ImageSpec(2, 2, 3, OIIO::TypeDesc::FLOAT),
                                     OIIO::ImageSpec(2, 2, 1, OIIO::TypeDesc::FLOAT)};
  specs[0].channelnames = {"R", "G", "B"};
  specs[1].channelnames = {"depth.Z"};
  const std::vector<float> rgb{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, depth{0.1f, 0.2f, 0.3f, 0.4f};
  const auto output = OIIO::ImageOutput::create("a.exr");
  const std::string name = (folder / "a.exr").string();
  ASSERT_TRUE(output->open(name, 2, specs.data()) && output->write_image(OIIO::TypeDesc::FLOAT, rgb.data()));
  ASSERT_TRUE(output->open(name, specs[1], OIIO::ImageOutput::AppendSubimage));
  ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, depth.data()) && output->close());
  const Image image = read_image(folder / "a.exr");
  EXPECT_THAT(image.channels, ElementsAre("R", "G", "B", "depth.Z"));
  EXPECT_EQ(image.at(1, 1, 0), 10.0f);
  EXPECT_EQ(image.at(1, 1, 3), 0.4f);
  EXPECT_EQ(image.at(0, 1, 2), 9.0f);
}

TEST(ImageIo, UnreadableFilesAreErrorsThatNameTheFile) {
  const test::Folder folder;
  EXPECT_THAT(io_error([&] { read_image(folder / "none.exr"); }), HasSubstr("none.exr: no such file"));
  write_file_atomic(folder / "text.exr", std::string_view("this is not an image"));
  EXPECT_THAT(io_error([&] { read_image(folder / "text.exr"); }), HasSubstr("text.exr"));
  write_file_atomic(folder / "empty.png", std::string_view());
  EXPECT_THAT(io_error([&] { read_image(folder / "empty.png"); }), HasSubstr("empty.png"));
  EXPECT_THAT(io_error([&] { read_image(folder.path()); }), HasSubstr("cannot read image"));

  test::write_exr(folder / "whole.exr", test::test_picture());
  const Bytes whole = read_file(folder / "whole.exr");
  write_file_atomic(folder / "cut.exr", std::span(whole).first(whole.size() / 2));
  EXPECT_THAT(io_error([&] { read_image(folder / "cut.exr"); }), HasSubstr("cut.exr"));
  EXPECT_THAT(io_error([&] { read_rgb(folder / "cut.exr"); }), HasSubstr("cut.exr"));

  Image grey{2, 2, {"Y"}, {1, 2, 3, 4}, false};
  test::write_exr(folder / "grey.exr", grey);
  EXPECT_THAT(io_error([&] { read_rgb(folder / "grey.exr"); }), HasSubstr("no channel R"));
}

TEST(ImageIo, PixelsThatDoNotFitTheSizeAreADefect) {
  EXPECT_THROW(encode_png(2, 2, std::vector<std::uint8_t>(11)), Error);
  EXPECT_THROW(encode_png(0, 0, {}), Error);
}

}  // namespace
}  // namespace vivify::render
