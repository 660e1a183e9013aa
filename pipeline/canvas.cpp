#include "pipeline/canvas.h"

#include <algorithm>
#include <cmath>

namespace vivify::pipeline {
namespace {

constexpr double kHeadLength = 4, kHeadHalfWidth = 1.8;  // of an arrow's head, in thicknesses

}  // namespace

template <class Distance>
void Canvas::stroke(Pixel low, Pixel high, double thickness, const Colour& colour, double opacity,
                    const Distance& distance) {
  const double radius = thickness / 2, margin = radius + 1;
  // Also refuses what is not finite.
  if (!(low.minCoeff() > -1e6 && high.maxCoeff() < 1e6)) return;
  const int left = std::max(0, static_cast<int>(low.x() - margin)),
            right = std::min(width_, static_cast<int>(high.x() + margin) + 1),
            top = std::max(0, static_cast<int>(low.y() - margin)),
            bottom = std::min(height_, static_cast<int>(high.y() + margin) + 1);
  for (int y = top; y < bottom; ++y) {
    for (int x = left; x < right; ++x) {
      const double cover = std::clamp(radius + 0.5 - distance(Pixel(x + 0.5, y + 0.5)), 0.0, 1.0) * opacity;
      if (cover == 0) continue;
      std::uint8_t* pixel = pixels_ + 3 * (static_cast<std::ptrdiff_t>(top_ + y) * row_width_ + left_ + x);
      for (std::size_t c = 0; c < 3; ++c)
        pixel[c] = static_cast<std::uint8_t>(std::lround((1 - cover) * pixel[c] + cover * colour[c]));
    }
  }
}

void Canvas::fill(const Colour& colour) {
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x)
      std::copy(colour.begin(), colour.end(),
                pixels_ + 3 * (static_cast<std::ptrdiff_t>(top_ + y) * row_width_ + left_ + x));
  }
}

void Canvas::line(const Pixel& from, const Pixel& to, double thickness, const Colour& colour,
                  double opacity) {
  const Pixel way = to - from;
  const double length2 = way.squaredNorm();
  stroke(from.cwiseMin(to), from.cwiseMax(to), thickness, colour, opacity, [&](const Pixel& at) {
    const double share = length2 > 0 ? std::clamp(way.dot(at - from) / length2, 0.0, 1.0) : 0.0;
    return (at - from - share * way).norm();
  });
}

void Canvas::ring(const Pixel& centre, double radius, double thickness, const Colour& colour,
                  double opacity) {
  const Pixel reach = Pixel::Constant(radius);
  stroke(centre - reach, centre + reach, thickness, colour, opacity,
         [&](const Pixel& at) { return std::abs((at - centre).norm() - radius); });
}

void Canvas::arrow(const Pixel& from, const Pixel& to, double thickness, const Colour& colour,
                   double opacity) {
  const double length = (to - from).norm();
  if (!(length > 0)) return;
  const Pixel along = (to - from) / length, across(-along.y(), along.x());
  const double head = std::min(kHeadLength * thickness, length);
  const double half_width = kHeadHalfWidth / kHeadLength * head;
  const Pixel base = to - head * along;
  if (length > head) line(from, base, thickness, colour, opacity);
  // Inside the head all three distances to its sides are negative.
  const double slope = std::hypot(head, half_width);
  stroke(to.cwiseMin(base).array() - half_width, to.cwiseMax(base).array() + half_width, 0, colour, opacity,
         [&](const Pixel& at) {
           const double s = along.dot(at - base), t = std::abs(across.dot(at - base));
           return std::max(-s, (head * (t - half_width) + half_width * s) / slope);
         });
}

}  // namespace vivify::pipeline
