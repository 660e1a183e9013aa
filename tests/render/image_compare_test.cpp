#include "render/image_compare.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/render/test_images.h"

namespace vivify::render {
namespace {

using testing::HasSubstr;

constexpr CompareLimits kExact{.exact = true};

const PlaneComparison& plane(const ImageComparison& comparison, const std::string& name) {
  for (const PlaneComparison& candidate : comparison.planes) {
    if (candidate.name == name) return candidate;
  }
  ADD_FAILURE() << "no plane " << name;
  return comparison.planes.front();
}

// Names of the planes that differ, one after the other.
std::string different(const ImageComparison& comparison) {
  std::string names;
  for (const PlaneComparison& candidate : comparison.planes) {
    if (!candidate.same) names += (names.empty() ? "" : " ") + candidate.name;
    EXPECT_EQ(candidate.same, candidate.reason.empty());
  }
  EXPECT_EQ(comparison.same, names.empty());
  return names;
}

Image multiplied(Image image, const std::string& layer, float factor) {
  for (const char* channel : {"R", "G", "B"}) {
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) test::value(image, x, y, layer + channel) *= factor;
    }
  }
  return image;
}

TEST(ImageCompare, AnImageIsTheSameAsItself) {
  const Image image = test::test_picture();
  for (const CompareLimits& limits : {CompareLimits{}, kExact}) {
    const ImageComparison comparison = compare_images(image, image, limits);
    EXPECT_EQ(different(comparison), "");
    EXPECT_EQ(comparison.planes.size(), 5u);
    for (const PlaneComparison& p : comparison.planes)
      EXPECT_EQ(p.max_error + p.mean_error + p.signed_mean, 0) << p.name;
  }
}

TEST(ImageCompare, OneBitIsADifferenceInExactModeOnly) {
  const Image ref = test::test_picture();
  Image test = ref;
  float& red = test::value(test, 13, 29, "R");
  red = std::nextafter(red, 2.0f);
  EXPECT_EQ(different(compare_images(ref, test)), "");
  const ImageComparison exact = compare_images(ref, test, kExact);
  EXPECT_EQ(different(exact), "beauty");
  EXPECT_EQ(plane(exact, "beauty").failing_pixels, 1);
  EXPECT_EQ(plane(exact, "beauty").worst_x, 13);
  EXPECT_EQ(plane(exact, "beauty").worst_y, 29);
  test = ref;
  test::value(test, 0, 0, "depth.Z") = -0.0f;  // the background is +0
  EXPECT_EQ(different(compare_images(ref, test, kExact)), "depth");
}

TEST(ImageCompare, RoundingOfAnotherProcessorPasses) {
  const Image ref = test::test_picture();
  Image test = ref;
  CounterRng rng(3);
  for (std::size_t i = 0; i < test.values.size(); ++i) {
    if ((i + 1) % ref.channels.size() == 0) continue;  // object numbers are whole
    test.values[i] *= 1 + static_cast<float>(rng.uniform(-2e-6, 2e-6));
  }
  EXPECT_EQ(different(compare_images(ref, test)), "");
  EXPECT_GT(plane(compare_images(ref, test), "beauty").max_error, 0);
}

TEST(ImageCompare, ASinglePathThatTurnsTheOtherWayPasses) {
  const Image ref = test::test_picture();
  Image test = ref;
  for (const char* channel : {"R", "G", "B"}) test::value(test, 40, 20, channel) *= 1.1f;
  EXPECT_EQ(different(compare_images(ref, test)), "");
  EXPECT_EQ(plane(compare_images(ref, test), "beauty").failing_pixels, 1);
}

TEST(ImageCompare, OnePercentMoreAlbedoIsCaught) {
  const Image ref = test::test_picture();
  EXPECT_EQ(different(compare_images(ref, multiplied(multiplied(ref, "", 1.01f), "albedo.", 1.01f))),
            "beauty albedo");
  EXPECT_EQ(different(compare_images(ref, multiplied(ref, "", 0.99f))), "beauty");
  // On one small object only: the block means see it, the mean of the image does not.
  const Image big = test::test_picture(320, 180);
  Image test = big;
  for (int y = 100; y < 116; ++y) {
    for (int x = 150; x < 166; ++x) {
      for (const char* channel : {"R", "G", "B"}) test::value(test, x, y, channel) *= 1.01f;
    }
  }
  const ImageComparison comparison = compare_images(big, test);
  EXPECT_EQ(different(comparison), "beauty");
  EXPECT_THAT(plane(comparison, "beauty").reason, testing::StartsWith("8x8 block at (152, 104)"));
}

TEST(ImageCompare, ASmallBiasOfAllPixelsIsCaught) {
  const Image ref = test::test_picture();
  const ImageComparison comparison =
      compare_images(ref, multiplied(ref, "", 1.0015f), {.mean = 1, .block = 1});
  EXPECT_EQ(different(comparison), "beauty");
  EXPECT_THAT(plane(comparison, "beauty").reason, testing::StartsWith("bias 0.1"));
  EXPECT_EQ(different(compare_images(ref, multiplied(ref, "", 1.0003f))), "");
}

TEST(ImageCompare, AShiftByOnePixelIsCaught) {
  const Image ref = test::test_picture();
  for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(0, 1), std::pair(-1, 0)}) {
    Image test = ref;
    for (int y = 0; y < ref.height; ++y) {
      for (int x = 0; x < ref.width; ++x) {
        const int sx = std::clamp(x + dx, 0, ref.width - 1), sy = std::clamp(y + dy, 0, ref.height - 1);
        for (const std::string& name : ref.channels) {
          test::value(test, x, y, name) = ref.at(sx, sy, test::channel_index(ref, name));
        }
      }
    }
    EXPECT_EQ(different(compare_images(ref, test)), "beauty albedo normal depth id") << dx << ", " << dy;
  }
}

TEST(ImageCompare, AFireflyIsCaughtEvenInALargeImage) {
  const Image ref = test::test_picture(320, 180);
  Image test = ref;
  test::value(test, 250, 17, "G") += 5;
  const ImageComparison comparison = compare_images(ref, test);
  EXPECT_EQ(different(comparison), "beauty");
  EXPECT_THAT(plane(comparison, "beauty").reason, HasSubstr("8x8 block at (248, 16)"));
  EXPECT_EQ(plane(comparison, "beauty").worst_x, 250);
  EXPECT_EQ(plane(comparison, "beauty").worst_y, 17);
}

TEST(ImageCompare, NanAndInfinityAreCaughtInEveryPlane) {
  const Image ref = test::test_picture(320, 180);
  for (const float wrong :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    for (const char* channel : {"B", "albedo.R", "normal.Y", "depth.Z", "id.ID", "A"}) {
      Image test = ref;
      test::value(test, 319, 179, channel) = wrong;
      for (const CompareLimits& limits : {CompareLimits{}, kExact}) {
        const ImageComparison comparison = compare_images(ref, test, limits);
        EXPECT_FALSE(comparison.same) << channel;
        EXPECT_NE(different(comparison), "") << channel;
        EXPECT_FALSE(compare_images(test, ref, limits).same) << channel;
        EXPECT_EQ(compare_images(test, test, limits).same, true) << channel;
      }
    }
  }
}

TEST(ImageCompare, SilhouettesMayDifferABit) {
  const Image ref = test::test_picture(320, 180);  // 57 pixels are 0.1 %
  Image test = ref;
  const auto change = [&](int count) {
    for (int i = 0; i < count; ++i) {
      test::value(test, i, 3, "depth.Z") = 9;
      test::value(test, i, 3, "id.ID") = 3;
    }
  };
  change(57);
  EXPECT_EQ(different(compare_images(ref, test)), "");
  EXPECT_EQ(different(compare_images(ref, test, kExact)), "depth id");
  change(58);
  const ImageComparison comparison = compare_images(ref, test);
  EXPECT_EQ(different(comparison), "depth id");
  EXPECT_EQ(plane(comparison, "id").failing_pixels, 58);
}

TEST(ImageCompare, SizesAndChannelsMustAgree) {
  const Image ref = test::test_picture();
  const ImageComparison size = compare_images(ref, test::test_picture(36, 64));
  EXPECT_FALSE(size.same);
  EXPECT_EQ(size.reason, "the size is 36x64, not 64x36");
  Image test = ref;
  test.channels.back() = "mask.M";
  EXPECT_EQ(compare_images(ref, test).reason, "channel id.ID is missing");
  test.channels = ref.channels;
  Image less = ref;
  less.channels.pop_back();
  less.values.clear();
  for (std::size_t i = 0; i < ref.values.size(); ++i) {
    if ((i + 1) % ref.channels.size() != 0) less.values.push_back(ref.values[i]);
  }
  EXPECT_EQ(compare_images(less, ref).reason, "channel id.ID is not in the reference");
  test.display_encoded = true;
  EXPECT_FALSE(compare_images(ref, test).same);
  EXPECT_TRUE(heat_map(size).empty());
}

TEST(ImageCompare, TheOrderOfTheChannelsDoesNotMatter) {
  Image ref{1, 1, {"R", "G", "B"}, {1, 2, 3}, false};
  Image test{1, 1, {"B", "G", "R"}, {3, 2, 1}, false};
  EXPECT_TRUE(compare_images(ref, test, kExact).same);
}

TEST(ImageCompare, DisplayImagesAreComparedInDisplayUnits) {
  Image ref{64, 36, {"R", "G", "B"}, std::vector<float>(64 * 36 * 3, 3 / 255.0f), true};
  Image test = ref;
  test.values[600] += 1 / 255.0f;  // one step in a dark pixel: a third of its value
  EXPECT_TRUE(compare_images(ref, test).same);
  EXPECT_FALSE(compare_images(ref, test, kExact).same);
  for (float& value : test.values) value += 1 / 255.0f;
  EXPECT_FALSE(compare_images(ref, test).same);
}

TEST(ImageCompare, TheHeatMapShowsWhereTheErrorIs) {
  const Image ref = test::test_picture();
  Image test = ref;
  test::value(test, 11, 7, "R") += 100;
  test::value(test, 12, 7, "R") += 1e-9f;
  const std::vector<std::uint8_t> map = heat_map(compare_images(ref, test));
  ASSERT_EQ(map.size(), 3u * 64 * 36);
  for (std::size_t i = 0; i < map.size(); ++i) EXPECT_EQ(map[i], i / 3 == 7 * 64 + 11 ? 255 : 0) << i;
}

}  // namespace
}  // namespace vivify::render
