// Maps from the unit square to the domains that are sampled, with their densities.
#pragma once

#include <cstddef>
#include <vector>

#include "render/vec.h"

namespace vivify::render {

// Unit disk, concentric [Shirley and Chiu 1997]; density 1/π.
Vec2 sample_disk(const Vec2& u);

// Hemisphere around +z with density cos θ / π.
Vec3 sample_cosine_hemisphere(const Vec2& u);

// Cone around +z of directions with cos θ >= cos_max; density 1 / (2π (1 − cos_max)).
// `one_minus_cos_max` is given for the sake of narrow cones.
Vec3 sample_cone(const Vec2& u, float one_minus_cos_max);
float cone_pdf(float one_minus_cos_max);

// Tent (triangle) of radius 1 around 0: density 1 − |x|.
float sample_tent(float u);

// Power heuristic (β = 2) for one sample of each strategy [Veach and Guibas 1995].
inline float mis_weight(float pdf, float other) {
  const float a = pdf * pdf;
  const float b = other * other;
  return a > 0 ? a / (a + b) : 0;
}

// Piecewise-constant density over n cells.
class Distribution1D {
 public:
  Distribution1D() = default;
  explicit Distribution1D(const std::vector<double>& weights);  // not negative

  std::size_t size() const { return probability_.size(); }
  double total() const { return total_; }  // of the weights
  // Cell that u falls into; u becomes its place in the cell, in [0, 1). There must be a positive weight.
  std::size_t sample(float& u) const;
  float probability(std::size_t cell) const { return probability_[cell]; }

 private:
  std::vector<float> cdf_;  // upper ends of the cells
  std::vector<float> probability_;
  double total_ = 0;
};

// Piecewise-constant density over the unit square, rows from y = 0.
class Distribution2D {
 public:
  Distribution2D() = default;
  Distribution2D(const std::vector<double>& weights, std::size_t width, std::size_t height);

  double total() const { return rows_.total(); }
  Vec2 sample(Vec2 u, float& pdf) const;
  float pdf(const Vec2& point) const;

 private:
  std::vector<Distribution1D> columns_;
  Distribution1D rows_;
  std::size_t width_ = 0;
};

}  // namespace vivify::render
