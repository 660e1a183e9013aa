// Comparison of two images, plane by plane: `vivify diff` and the golden image tests are this.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/image_io.h"

namespace vivify::render {

// Limits of the comparison. The error of a value is |test - ref| / (|ref| + 0.01) in linear light, |test -
// ref| in display-encoded images (PNG), and |test - ref| / max(1, |ref|) in geometry planes; the error of a
// pixel is the largest of its channels.
struct CompareLimits {
  bool exact = false;  // every bit of every value must agree; nothing below is used

  // Colours: a good renderer on another processor stays far below, one percent more albedo does not.
  double mean = 1e-3;           // mean error of the pixels
  double pixel = 0.02;          // a pixel with a larger error fails ...
  double failing_share = 1e-3;  // ... and at most this share of the pixels may fail
  double block = 5e-3;  // error of the mean of each 8 by 8 block: single paths differ, block means do not
  double signed_mean = 1e-3;  // |sum(test - ref)| / sum(|ref| + 0.01) of any channel: a bias no pixel shows

  // Geometry: everything agrees but for silhouettes, where a sample may hit the one or the other side.
  double rounding = 1e-5;          // a smaller error is none
  double silhouette_share = 1e-3;  // share of the pixels that may differ
};

// A plane is a group of channels with one layer name: "albedo.R", "albedo.G", "albedo.B" are the plane
// "albedo"; channels without a layer are the plane "beauty". The planes depth, normal, position, motion and
// id are geometry, all others are colours.
struct PlaneComparison {
  std::string name;
  bool same = true;
  std::string reason;      // why not, in words; empty when same
  double max_error = 0;    // infinite where one value is finite and the other is not
  double mean_error = 0;   // over the pixels of finite error
  double signed_mean = 0;  // of colours: the bias of the channel that has the largest
  long failing_pixels =
      0;  // exact: that differ in a bit; colours: beyond `pixel`; geometry: beyond `rounding`
  int worst_x = 0, worst_y = 0;  // the pixel of the largest error, from the top left
};

struct ImageComparison {
  bool same = true;
  std::string reason;                   // why the images cannot be compared at all (size, channels)
  std::vector<PlaneComparison> planes;  // in the order of the reference
  int width = 0, height = 0;
  std::vector<float>
      error;  // height by width: the largest error of the pixel in any plane; empty: not compared
};

// Compares `test` with `ref`. Values that are not finite agree only with the same value, and no limit excuses
// them.
ImageComparison compare_images(const Image& ref, const Image& test, const CompareLimits& limits = {});

// The errors as sRGB pixels (height by width by 3) on a logarithmic scale: black below 1e-4, blue, red,
// yellow, white at 1 and above. Empty when the images were not compared.
std::vector<std::uint8_t> heat_map(const ImageComparison& comparison);

}  // namespace vivify::render
