#include "render/warp.h"

namespace vivify::render {
namespace {
constexpr float kBelowOne = 0x1.fffffep-1f;
}

Vec2 sample_disk(const Vec2& u) {
  const float x = 2 * u.x - 1;
  const float y = 2 * u.y - 1;
  if (x == 0 && y == 0) return {};
  float r, phi;
  if (std::abs(x) > std::abs(y)) {
    r = x;
    phi = (kPi / 4) * (y / x);
  } else {
    r = y;
    phi = (kPi / 2) - (kPi / 4) * (x / y);
  }
  return {r * std::cos(phi), r * std::sin(phi)};
}

Vec3 sample_cosine_hemisphere(const Vec2& u) {
  const Vec2 d = sample_disk(u);
  return {d.x, d.y, std::sqrt(std::max(0.0f, 1 - d.x * d.x - d.y * d.y))};
}

Vec3 sample_cone(const Vec2& u, float one_minus_cos_max) {
  const float c = u.x * one_minus_cos_max;  // 1 − cos θ
  const float sine = std::sqrt(std::max(0.0f, c * (2 - c)));
  const float phi = 2 * kPi * u.y;
  return {sine * std::cos(phi), sine * std::sin(phi), 1 - c};
}

float cone_pdf(float one_minus_cos_max) { return 1 / (2 * kPi * one_minus_cos_max); }

float sample_tent(float u) { return u < 0.5f ? std::sqrt(2 * u) - 1 : 1 - std::sqrt(2 * (1 - u)); }

Distribution1D::Distribution1D(const std::vector<double>& weights)
    : cdf_(weights.size()), probability_(weights.size()) {
  for (const double w : weights) total_ += w;
  double sum = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sum += weights[i];
    cdf_[i] = total_ > 0 ? static_cast<float>(sum / total_) : 0;
    probability_[i] = total_ > 0 ? static_cast<float>(weights[i] / total_) : 0;
  }
}

std::size_t Distribution1D::sample(float& u) const {
  std::size_t cell = static_cast<std::size_t>(std::upper_bound(cdf_.begin(), cdf_.end(), u) - cdf_.begin());
  if (cell >= cdf_.size()) {  // the last end may be rounded below u
    cell = cdf_.size() - 1;
    while (probability_[cell] == 0) --cell;
  }
  const float low = cell == 0 ? 0 : cdf_[cell - 1];
  const float width = cdf_[cell] - low;
  u = width > 0 ? std::clamp((u - low) / width, 0.0f, kBelowOne) : 0.5f;
  return cell;
}

Distribution2D::Distribution2D(const std::vector<double>& weights, std::size_t width, std::size_t height)
    : width_(width) {
  std::vector<double> totals(height);
  for (std::size_t y = 0; y < height; ++y) {
    const auto row = weights.begin() + static_cast<std::ptrdiff_t>(y * width);
    columns_.emplace_back(std::vector<double>(row, row + static_cast<std::ptrdiff_t>(width)));
    totals[y] = columns_.back().total();
  }
  rows_ = Distribution1D(totals);
}

Vec2 Distribution2D::sample(Vec2 u, float& pdf) const {
  const std::size_t y = rows_.sample(u.y);
  const std::size_t x = columns_[y].sample(u.x);
  const auto height = static_cast<float>(rows_.size());
  const auto width = static_cast<float>(width_);
  pdf = rows_.probability(y) * columns_[y].probability(x) * height * width;
  return {(static_cast<float>(x) + u.x) / width, (static_cast<float>(y) + u.y) / height};
}

float Distribution2D::pdf(const Vec2& point) const {
  const std::size_t height = rows_.size();
  const auto cell = [](float v, std::size_t n) {
    return std::min(static_cast<std::size_t>(std::max(0.0f, v * static_cast<float>(n))), n - 1);
  };
  const std::size_t y = cell(point.y, height);
  const std::size_t x = cell(point.x, width_);
  return rows_.probability(y) * columns_[y].probability(x) * static_cast<float>(height * width_);
}

}  // namespace vivify::render
