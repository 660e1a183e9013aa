#include "pipeline/sheet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.h"
#include "render/view_transform.h"
#include "tests/render/test_images.h"

namespace vivify::pipeline {
namespace {

namespace fs = std::filesystem;

class SheetTest : public testing::Test {
 protected:
  // `count` flat frames; frame i has the light of light(i).
  void write_frames(const fs::path& where, int count) const {
    fs::create_directories(where);
    for (int i = 0; i < count; ++i) {
      std::string number = std::to_string(i + 1);
      number.insert(0, 4 - number.size(), '0');
      test::write_flat_exr(where / ("clip." + number + ".exr"), 64, 36, light(i), 0.1f, 0.1f);
    }
  }
  static float light(int i) { return 0.02f * static_cast<float>(i + 1); }

  // The red of the middle of picture `i` of the sheet with `columns`, as 8 bits.
  static int red_in_sheet(const render::Image& sheet, int i, int columns, int rows) {
    const int x = static_cast<int>((i % columns + 0.5) * sheet.width / columns);
    const int y = static_cast<int>((i / columns + 0.5) * sheet.height / rows);
    return static_cast<int>(std::lround(255 * sheet.at(x, y, 0)));
  }
  static int expected_red(int frame) {
    return render::ViewTransform(render::Display::srgb)
        .pixels(std::vector<float>{light(frame), 0.1f, 0.1f})[0];
  }

  render::Image read(const Bytes& png) const {
    write_file_atomic(folder_ / "sheet.png", png);
    return render::read_image(folder_ / "sheet.png");
  }

  test::Folder folder_;
};

TEST_F(SheetTest, ShowsEvenlySpacedFramesInOrder) {
  write_frames(folder_ / "out/render", 31);
  const render::Image sheet = read(contact_sheet(folder_ / "out", {.columns = 3, .frames = 6, .width = 600}));
  EXPECT_NEAR(sheet.width, 600, 4);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(red_in_sheet(sheet, i, 3, 2), expected_red(6 * i)) << i;
}

TEST_F(SheetTest, ShowsAllFramesWhenThereAreFew) {
  write_frames(folder_ / "frames", 3);
  const render::Image sheet =
      read(contact_sheet(folder_ / "frames", {.columns = 8, .frames = 16, .width = 400}));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(red_in_sheet(sheet, i, 3, 1), expected_red(i)) << i;
  const render::Image one =
      read(contact_sheet(folder_ / "frames", {.columns = 2, .frames = 1, .width = 100}));
  EXPECT_EQ(red_in_sheet(one, 0, 1, 1), expected_red(0));
}

TEST_F(SheetTest, PicturesKeepTheirShape) {
  write_frames(folder_ / "frames", 4);
  const render::Image sheet =
      read(contact_sheet(folder_ / "frames", {.columns = 2, .frames = 4, .width = 274}));
  EXPECT_EQ(sheet.width, 274);  // gaps of 6, pictures of 128 by 72, numbers in strips of 13
  EXPECT_EQ(sheet.height, 6 + 2 * (72 + 13 + 6));
}

TEST_F(SheetTest, NumbersAreBelowThePictures) {
  write_frames(folder_ / "frames", 1);
  const render::Image sheet =
      read(contact_sheet(folder_ / "frames", {.columns = 1, .frames = 1, .width = 332}));
  const auto white = [&](int from, int to) {  // pixels of these rows
    int found = 0;
    for (int y = from; y < to; ++y) {
      for (int x = 0; x < sheet.width; ++x) found += sheet.at(x, y, 0) > 0.9f && sheet.at(x, y, 2) > 0.9f;
    }
    return found;
  };
  EXPECT_EQ(white(0, 6 + 180), 0);
  EXPECT_GT(white(6 + 180, sheet.height), 40);
}

TEST_F(SheetTest, TheSameFramesGiveTheSameBytes) {
  write_frames(folder_ / "frames", 5);
  EXPECT_EQ(contact_sheet(folder_ / "frames"), contact_sheet(folder_ / "frames"));
}

TEST_F(SheetTest, NoFramesIsAnErrorThatNamesTheFolder) {
  fs::create_directories(folder_ / "empty");
  for (const char* name : {"empty", "none"}) {
    try {
      contact_sheet(folder_ / name);
      FAIL() << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::io);
      EXPECT_THAT(error.what(), testing::HasSubstr((folder_ / name).string()));
    }
  }
}

TEST_F(SheetTest, SettingsThatLeaveNoRoomAreUsageErrors) {
  write_frames(folder_ / "frames", 4);
  for (const SheetSettings& settings :
       {SheetSettings{.columns = 0}, SheetSettings{.frames = 0}, SheetSettings{.columns = 4, .width = 20},
        SheetSettings{.width = -5}}) {
    try {
      contact_sheet(folder_ / "frames", settings);
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
    }
  }
}

}  // namespace
}  // namespace vivify::pipeline
