// From scene light to display pixels: the ACES 1.x SDR output transform, assembled in code (no configuration
// file).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace vivify::render {

// The display that pixels are encoded for.
enum class Display {
  srgb,    // sRGB curve, Rec.709 primaries: PNG files
  rec709,  // Rec.1886 curve, Rec.709 primaries: video tagged bt709
};

// The colours of the renderer are linear light with Rec.709 (= sRGB) primaries and white D65; 0.18 is a mid
// grey, values above 1 are allowed. The way to the display:
//   exposure -> ACES2065-1 (rec709_to_aces) -> ACES RRT and ODT "SDR-VIDEO 1.0" -> encoding of the display.
// NaN counts as 0, negative values as 0, and values above 65504 (also infinity) as 65504.
class ViewTransform {
 public:
  // `exposure_stops`: the light is multiplied by 2^exposure_stops first.
  explicit ViewTransform(Display display, double exposure_stops = 0);
  ~ViewTransform();
  ViewTransform(ViewTransform&&) noexcept;
  ViewTransform& operator=(ViewTransform&&) noexcept;

  // Transforms #P RGB triples in place to display values in [0, 1]. Thread-safe.
  void apply(std::span<float> rgb) const;

  // The 8-bit pixels (3 #P bytes, rounded to nearest) of 3 #P scene values; in parallel, the same for any
  // number of threads.
  std::vector<std::uint8_t> pixels(std::span<const float> rgb) const;

 private:
  struct Processor;
  std::unique_ptr<Processor> processor_;
};

// Linear Rec.709 (white D65) to ACES2065-1 (primaries AP0, white about D60), with Bradford adaptation of the
// white; computed from the chromaticities of ITU-R BT.709-6 and SMPTE ST 2065-1:2012. Greys stay greys.
Eigen::Matrix3d rec709_to_aces();

}  // namespace vivify::render
