#include "render/textures/texture.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "common/error.h"
#include "render/image_io.h"
#include "render/scene.h"
#include "render/textures/image.h"
#include "tests/common/glb.h"
#include "tests/common/temporary_folder.h"
#include "tests/render/render_support.h"

namespace vivify::render {
namespace {

using testing_support::settings;
using vivify::testing_support::glb_text;
using vivify::testing_support::TemporaryFolder;

// Red and green above, blue and white below.
Bytes four_colors() {
  const std::vector<std::uint8_t> rgb = {255, 0, 0, 0, 255, 0, 0, 0, 255, 188, 188, 188};
  return encode_png(2, 2, rgb);
}

TEST(Texture, OrientationAndEncoding) {
  const TemporaryFolder folder;
  write_file_atomic(folder.path() / "four.png", four_colors());
  const auto look = [&](const std::string& more) {
    return ColorSource(
        settings(material_schema(),
                 "{type: diffuse, color: [1, 1, 0.5], texture: {type: image, file: four.png" + more + "}}"),
        folder.path());
  };
  const ColorSource color = look("");
  ASSERT_TRUE(color.textured());
  EXPECT_EQ(color.at({{0.25f, 0.75f}, 0}), Vec3(1, 0, 0));  // v = 0 is the bottom row
  EXPECT_EQ(color.at({{0.75f, 0.75f}, 0}), Vec3(0, 1, 0));
  EXPECT_EQ(color.at({{0.25f, 0.25f}, 0}), Vec3(0, 0, 0.5f));
  const Vec3 grey = color.at({{0.75f, 0.25f}, 0});
  EXPECT_NEAR(grey.x, 0.5029f, 1e-3f);  // IEC 61966-2-1 at 188/255
  EXPECT_NEAR(grey.z, 0.5029f / 2, 1e-3f);
  EXPECT_NEAR(look(", colorspace: linear").at({{0.75f, 0.25f}, 0}).x, 188 / 255.0f, 1e-5f);
  // Between two texel centres it is half of each, and it repeats.
  EXPECT_NEAR(color.at({{0.5f, 0.75f}, 0}).x, 0.5f, 1e-5f);
  EXPECT_NEAR(color.at({{0.5f, 0.75f}, 0}).y, 0.5f, 1e-5f);
  EXPECT_NEAR(color.at({{1.0f, 0.75f}, 0}).x, 0.5f, 1e-5f);
  EXPECT_EQ(color.at({{-0.75f, 1.75f}, 0}), Vec3(1, 0, 0));
  EXPECT_EQ(look(", scale: 2").at({{0.125f, 0.375f}, 0}), Vec3(1, 0, 0));
  // A sample as wide as the picture sees its mean.
  EXPECT_NEAR(color.at({{0.3f, 0.9f}, 4}).x, (1 + 0.5029f) / 4, 1e-3f);
}

TEST(Texture, ImagesInsideAGlbLookLikeThoseInFiles) {
  const TemporaryFolder folder;
  const Bytes image = four_colors();
  std::string binary = "something";
  const std::string view = R"({"byteOffset":9,"byteLength":)" + std::to_string(image.size()) + "}";
  binary.append(reinterpret_cast<const char*>(image.data()), image.size());
  write_file_atomic(folder / "four.png", image);
  write_file_atomic(folder / "cup.glb",
                    glb_text(R"({"images":[{"bufferView":0}],"bufferViews":[)" + view + "]}", binary));
  const Location where{"scene.yaml", 7, 1};
  EXPECT_EQ(read_picture(folder / "cup.glb", "automatic", where, 0).texels,
            read_picture(folder / "four.png", "automatic", where).texels);
  const ColorSource color(
      settings(material_schema(), "{type: diffuse, texture: {type: image, file: cup.glb, image: 0}}"),
      folder.path());
  EXPECT_EQ(color.at({{0.75f, 0.75f}, 0}).x, 0);  // 0.8 of green
  EXPECT_FLOAT_EQ(color.at({{0.75f, 0.75f}, 0}).y, 0.8f);
  try {
    read_picture(folder / "cup.glb", "automatic", where, 1);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::io);
    EXPECT_EQ(error.where().line, 7);
  }
}

TEST(Texture, MipLevelsKeepTheMean) {
  Picture picture{8, 8, {}};
  for (int i = 0; i < 64; ++i) picture.texels.push_back(Vec3(static_cast<float>(i)));
  const auto levels = mip_levels(picture);
  ASSERT_EQ(levels.size(), 4u);
  EXPECT_FLOAT_EQ(levels.back().texels[0].x, 31.5f);
  const auto odd = mip_levels({5, 3, std::vector<Vec3>(15, Vec3(2))});
  EXPECT_EQ(odd.back().width * odd.back().height, 1);
  EXPECT_FLOAT_EQ(odd.back().texels[0].x, 2);
}

TEST(Texture, CheckerAveragesOverItsWidth) {
  const ColorSource color(settings(material_schema(),
                                   "{type: diffuse, color: [1, 1, 1], texture: {type: checker, even: [1, 1, "
                                   "1], odd: [0, 0, 0], scale: 2}}"),
                          "");
  EXPECT_NEAR(color.at({{0.25f, 0.25f}, 0}).x, 1, 1e-3f);
  EXPECT_NEAR(color.at({{0.75f, 0.25f}, 0}).x, 0, 1e-3f);
  EXPECT_NEAR(color.at({{0.75f, 0.75f}, 0}).x, 1, 1e-3f);
  EXPECT_NEAR(color.at({{-0.25f, 0.25f}, 0}).x, 0, 1e-3f);
  EXPECT_NEAR(color.at({{0.3f, 0.2f}, 1}).x, 0.5f, 1e-3f);
}

TEST(Texture, MissingFileIsNamed) {
  const Value value =
      settings(material_schema(), "{type: diffuse, texture: {type: image, file: nowhere.png}}");
  try {
    const ColorSource color(value, "assets");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::io);
    EXPECT_NE(std::string(e.what()).find("nowhere.png"), std::string::npos);
    EXPECT_GT(e.where().line, 0);
  }
}

TEST(Texture, FilesAreListedForTheCache) {
  Looks looks;
  looks.folder = "scenes";
  looks.materials["wood"] =
      settings(material_schema(), "{type: diffuse, texture: {type: image, file: wood.png}}");
  looks.lights = {settings(light_schema(), "{type: environment, file: room.exr}"),
                  settings(light_schema(), "{type: sky}")};
  EXPECT_EQ(referenced_files(looks),
            (std::vector<std::filesystem::path>{"scenes/wood.png", "scenes/room.exr"}));
}

}  // namespace
}  // namespace vivify::render
