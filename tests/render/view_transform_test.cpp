#include "render/view_transform.h"

#include <OpenColorIO/OpenColorIO.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "common/parallel.h"
#include "common/rng.h"

namespace vivify::render {
namespace {

float grey_on(Display display, float light, double exposure = 0) {
  std::vector<float> rgb{light, light, light};
  ViewTransform(display, exposure).apply(rgb);
  EXPECT_NEAR(rgb[0], rgb[1], 2e-4);
  EXPECT_NEAR(rgb[1], rgb[2], 2e-4);
  return rgb[1];
}

// The chain ACEScg -> ACES2065-1 -> SDR-VIDEO -> display was measured by itself for these greys; greys are
// the same in linear Rec. 709, since the matrix maps white to white.
TEST(ViewTransform, MeetsTheReferenceValuesOfAcesOnSrgb) {
  EXPECT_NEAR(grey_on(Display::srgb, 0.18f), 0.355954, 1e-4);
  EXPECT_NEAR(grey_on(Display::srgb, 1.0f), 0.811971, 1e-4);
  EXPECT_NEAR(grey_on(Display::srgb, 16.0f), 0.999741, 1e-4);
}

TEST(ViewTransform, MeetsTheReferenceValuesOfAcesOnRec709) {
  EXPECT_NEAR(grey_on(Display::rec709, 0.0f), 0.000049, 2e-5);
  EXPECT_NEAR(grey_on(Display::rec709, 0.18f), 0.389530, 1e-4);
  EXPECT_NEAR(grey_on(Display::rec709, 1.0f), 0.821773, 1e-4);
  EXPECT_NEAR(grey_on(Display::rec709, 16.0f), 0.999754, 1e-4);
}

// OpenColorIO holds the published matrices of the same conversion; ours comes from the chromaticities.
TEST(ViewTransform, MatrixAgreesWithOpenColorIo) {
  namespace ocio = OCIO_NAMESPACE;
  const auto group = ocio::GroupTransform::Create();
  const auto from_rec709 = ocio::BuiltinTransform::Create();
  from_rec709->setStyle("UTILITY - ACES-AP1_to_LINEAR-REC709_BFD");
  from_rec709->setDirection(ocio::TRANSFORM_DIR_INVERSE);
  const auto to_ap0 = ocio::BuiltinTransform::Create();
  to_ap0->setStyle("ACEScg_to_ACES2065-1");
  group->appendTransform(from_rec709);
  group->appendTransform(to_ap0);
  const auto processor = ocio::Config::CreateRaw()->getProcessor(group)->getDefaultCPUProcessor();
  const Eigen::Matrix3d matrix = rec709_to_aces();
  for (int c = 0; c < 3; ++c) {
    std::array<float, 3> rgb{};
    rgb[static_cast<std::size_t>(c)] = 1;
    processor->applyRGB(rgb.data());
    for (int r = 0; r < 3; ++r)
      EXPECT_NEAR(matrix(r, c), rgb[static_cast<std::size_t>(r)], 2e-5) << r << ", " << c;
  }
}

TEST(ViewTransform, MatrixKeepsGreysAndIsRegular) {
  const Eigen::Matrix3d matrix = rec709_to_aces();
  EXPECT_LE((matrix * Eigen::Vector3d::Ones() - Eigen::Vector3d::Ones()).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_GT(matrix.determinant(), 0.1);
  EXPECT_GT(matrix.minCoeff(), 0);  // AP0 holds every colour of Rec. 709
}

TEST(ViewTransform, WrongLightIsHarmless) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (const Display display : {Display::srgb, Display::rec709}) {
    const ViewTransform view(display);
    std::vector<float> wrong{-1, kInfinity, kNan, -kInfinity, kNan, 0.18f, 1e30f, 0.2f, 3.0f};
    std::vector<float> right{0, 65504, 0, 0, 0, 0.18f, 65504, 0.2f, 3.0f};
    view.apply(wrong);
    view.apply(right);
    EXPECT_EQ(wrong, right);
    for (const float value : wrong) {
      EXPECT_GE(value, 0);
      EXPECT_LE(value, 1);
    }
  }
}

TEST(ViewTransform, ExposureIsInStops) {
  for (const double stops : {-2.0, 1.0, 2.5}) {
    const float factor = static_cast<float>(std::exp2(stops));
    EXPECT_NEAR(grey_on(Display::srgb, 0.1f, stops), grey_on(Display::srgb, 0.1f * factor), 2e-5) << stops;
  }
}

TEST(ViewTransform, MoreLightIsBrighter) {
  for (const Display display : {Display::srgb, Display::rec709}) {
    float before = -1;
    for (float light = 1.0f / 256; light <= 16; light *= 1.25f) {
      const float now = grey_on(display, light);
      EXPECT_GT(now, before) << light;
      before = now;
    }
  }
}

TEST(ViewTransform, PixelsAreTheSameForAnyNumberOfThreads) {
  CounterRng rng(5);
  std::vector<float> light(3 * 50000);
  for (float& value : light) value = static_cast<float>(std::exp2(rng.uniform(-10, 5)));
  const ViewTransform view(Display::srgb);
  set_thread_count(1);
  const std::vector<std::uint8_t> one = view.pixels(light);
  set_thread_count(3);
  const std::vector<std::uint8_t> three = view.pixels(light);
  set_thread_count(0);
  EXPECT_EQ(one, three);
  view.apply(light);
  for (std::size_t i = 0; i < light.size(); ++i) ASSERT_EQ(one[i], std::lround(255 * light[i])) << i;
  EXPECT_TRUE(view.pixels({}).empty());
}

}  // namespace
}  // namespace vivify::render
