#include "pipeline/diff.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.h"
#include "tests/render/test_images.h"

namespace vivify::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

class DiffTest : public testing::Test {
 protected:
  fs::path write(const std::string& name, const render::Image& image) const {
    const fs::path path = folder_ / name;
    fs::create_directories(path.parent_path());
    test::write_exr(path, image);
    return path;
  }

  static ErrorKind error_of(const std::function<void()>& work) {
    try {
      work();
    } catch (const Error& error) {
      return error.kind();
    }
    ADD_FAILURE() << "no error";
    return ErrorKind::internal;
  }

  const render::Image picture_ = test::test_picture();
  const render::Image brighter_ = [this] {
    render::Image image = picture_;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) test::value(image, x, y, "G") *= 1.01f;
    }
    return image;
  }();
  test::Folder folder_;
};

TEST_F(DiffTest, TheSameFilesAreTheSame) {
  const fs::path a = write("a.exr", picture_), b = write("b.exr", picture_);
  const DiffReport report = diff(a, b, {.limits = {.exact = true}, .heat_map = {}});
  EXPECT_TRUE(report.same());
  const std::string shown = text(report);
  EXPECT_THAT(shown, HasSubstr("b.exr: same\n"));
  for (const char* plane : {"beauty", "albedo", "normal", "depth", "id"})
    EXPECT_THAT(shown, HasSubstr(plane));
  EXPECT_THAT(shown, Not(HasSubstr("DIFFERENT")));
}

TEST_F(DiffTest, ADifferenceIsShownWithItsReason) {
  const DiffReport report = diff(write("a.exr", picture_), write("b.exr", brighter_));
  EXPECT_FALSE(report.same());
  const std::string shown = text(report);
  EXPECT_THAT(shown, HasSubstr("b.exr: DIFFERENT\n"));
  EXPECT_THAT(shown, HasSubstr("DIFFERENT: mean error"));
}

TEST_F(DiffTest, AHeatMapIsWritten) {
  const fs::path map = folder_ / "map.png";
  diff(write("a.exr", picture_), write("b.exr", brighter_), {.limits = {}, .heat_map = map});
  const render::Image image = render::read_image(map);
  EXPECT_EQ(image.width, picture_.width);
  EXPECT_EQ(image.height, picture_.height);
  EXPECT_GT(*std::ranges::max_element(image.values), 0);
  EXPECT_EQ(error_of([&] {
              diff(folder_ / "a.exr", folder_ / "b.exr", {{}, folder_ / "none/map.png"});
            }),
            ErrorKind::io);
}

TEST_F(DiffTest, FoldersAreComparedByRelativeNames) {
  for (const std::string side : {"ref/", "test/"}) {
    write(side + "render/clip.0001.exr", picture_);
    write(side + "render/clip.0002.exr", side == "ref/" ? picture_ : brighter_);
  }
  write_file_atomic(folder_ / "ref/run.json", std::string_view("{}"));  // no image: not compared
  EXPECT_FALSE(diff(folder_ / "ref", folder_ / "test").same());
  write("ref/render/clip.0003.exr", picture_);
  write("test/render/clip.0004.exr", picture_);
  const DiffReport report =
      diff(folder_ / "ref", folder_ / "test", {.limits = {}, .heat_map = folder_ / "map.png"});
  ASSERT_EQ(report.files.size(), 4u);
  EXPECT_EQ(report.files[0].name, "render/clip.0001.exr");
  EXPECT_TRUE(report.files[0].same());
  EXPECT_FALSE(report.files[1].same());
  EXPECT_EQ(report.files[2].kind, FileDiff::Kind::missing);
  EXPECT_EQ(report.files[3].kind, FileDiff::Kind::extra);
  const std::string shown = text(report);
  EXPECT_THAT(shown, HasSubstr("render/clip.0001.exr: same\n"));
  EXPECT_THAT(shown, HasSubstr("render/clip.0003.exr: DIFFERENT: only in the reference\n"));
  EXPECT_THAT(shown, HasSubstr("render/clip.0004.exr: DIFFERENT: not in the reference\n"));
  EXPECT_THAT(shown, HasSubstr("3 of 4 images differ\n"));
  // The heat map is that of the first different image.
  const render::Image map = render::read_image(folder_ / "map.png");
  EXPECT_GT(*std::ranges::max_element(map.values), 0);
}

TEST_F(DiffTest, EqualFoldersAreTheSame) {
  for (const char* side : {"ref", "test"}) write(std::string(side) + "/a.exr", picture_);
  const DiffReport report = diff(folder_ / "ref", folder_ / "test");
  EXPECT_TRUE(report.same());
}

TEST_F(DiffTest, ImagesOfOtherSizesDiffer) {
  const DiffReport report = diff(write("a.exr", picture_), write("b.exr", test::test_picture(20, 20)));
  EXPECT_FALSE(report.same());
  EXPECT_THAT(text(report), HasSubstr("b.exr: DIFFERENT: the size is 20x20, not 64x36\n"));
}

TEST_F(DiffTest, PngFilesAreCompared) {
  std::vector<std::uint8_t> pixels(3 * 16 * 16, 100);
  write_file_atomic(folder_ / "a.png", render::encode_png(16, 16, pixels));
  write_file_atomic(folder_ / "b.png", render::encode_png(16, 16, pixels));
  EXPECT_TRUE(diff(folder_ / "a.png", folder_ / "b.png", {.limits = {.exact = true}, .heat_map = {}}).same());
  for (std::size_t i = 0; i < 30; ++i) pixels[i] = 110;
  write_file_atomic(folder_ / "b.png", render::encode_png(16, 16, pixels));
  EXPECT_FALSE(diff(folder_ / "a.png", folder_ / "b.png").same());
}

TEST_F(DiffTest, WrongInputsAreErrors) {
  const fs::path a = write("a.exr", picture_);
  fs::create_directories(folder_ / "empty1");
  fs::create_directories(folder_ / "empty2");
  EXPECT_EQ(error_of([&] { diff(a, folder_ / "none.exr"); }), ErrorKind::io);
  EXPECT_EQ(error_of([&] { diff(folder_ / "none", folder_ / "empty1"); }), ErrorKind::io);
  EXPECT_EQ(error_of([&] { diff(a, folder_ / "empty1"); }), ErrorKind::usage);
  EXPECT_EQ(error_of([&] { diff(folder_ / "empty1", folder_ / "empty2"); }), ErrorKind::usage);
  write_file_atomic(folder_ / "bad.exr", std::string_view("not an image"));
  EXPECT_EQ(error_of([&] { diff(a, folder_ / "bad.exr"); }), ErrorKind::io);
}

}  // namespace
}  // namespace vivify::pipeline
