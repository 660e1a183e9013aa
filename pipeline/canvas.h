// Anti-aliased drawing on a part of an 8-bit RGB picture.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>

namespace vivify::pipeline {

using Colour = std::array<std::uint8_t, 3>;  // sRGB
using Pixel = Eigen::Vector2d;               // from the upper left corner of the part, y is down

// The part of a picture that begins at pixel (left, top). What lies outside of it is not drawn.
class Canvas {
 public:
  // `pixels`: the whole picture, rows of `row_width` by 3, kept by pointer.
  Canvas(std::uint8_t* pixels, int row_width, int left, int top, int width, int height)
      : pixels_(pixels), row_width_(row_width), left_(left), top_(top), width_(width), height_(height) {}

  int width() const { return width_; }
  int height() const { return height_; }

  void fill(const Colour& colour);
  // A line with round ends; one of no length is a disc. `opacity` from 0 to 1.
  void line(const Pixel& from, const Pixel& to, double thickness, const Colour& colour, double opacity = 1);
  void disc(const Pixel& centre, double radius, const Colour& colour, double opacity = 1) {
    line(centre, centre, 2 * radius, colour, opacity);
  }
  void ring(const Pixel& centre, double radius, double thickness, const Colour& colour, double opacity = 1);
  // A line with a head at `to`.
  void arrow(const Pixel& from, const Pixel& to, double thickness, const Colour& colour, double opacity = 1);

 private:
  // Blends the colour into every pixel within the bounds as far as `distance` (pixels, of its centre to the
  // middle of the stroke) says that a stroke of that thickness covers it.
  template <class Distance>
  void stroke(Pixel low, Pixel high, double thickness, const Colour& colour, double opacity,
              const Distance& distance);

  std::uint8_t* pixels_;
  int row_width_, left_, top_, width_, height_;
};

}  // namespace vivify::pipeline
