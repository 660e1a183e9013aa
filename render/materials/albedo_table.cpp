#include "render/materials/albedo_table.h"

#include <cstdint>

#include "render/sampler.h"

namespace vivify::render {
namespace {
constexpr int kKnots = 128;
constexpr std::uint32_t kSamples = 1024;
constexpr int kLostCells = 64;
}  // namespace

AlbedoTable::AlbedoTable(const std::function<float(const Vec3& wo, const Vec2& u)>& weight) {
  for (int i = 0; i < kKnots; ++i) {
    const float root = std::max(static_cast<float>(i) / (kKnots - 1), 1e-3f);
    const float mu = root * root;
    const Vec3 wo = {std::sqrt(1 - mu * mu), 0, mu};
    double sum = 0;
    for (std::uint32_t s = 0; s < kSamples; ++s) {
      const auto x = sobol_4d(s);
      // Half a step off the lattice, away from the singular corners.
      sum += weight(wo, {(static_cast<float>(x[0] >> 8) + 0.5f) * 0x1p-24f + 0.5f / kSamples,
                         (static_cast<float>(x[1] >> 8) + 0.5f) * 0x1p-24f + 0.5f / kSamples});
    }
    values_.push_back(static_cast<float>(sum / kSamples));
  }
  // Midpoint rule over the interpolant.
  constexpr int kSteps = 4096;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double mu = (i + 0.5) / kSteps;
    sum += 2 * mu * at(static_cast<float>(mu)) / kSteps;
  }
  average_ = static_cast<float>(sum);

  // With r = √cos θ: cos θ d cos θ = 2 r³ dr.
  std::vector<double> lost;
  for (int i = 0; i < kLostCells; ++i) {
    const double r = (i + 0.5) / kLostCells;
    lost.push_back(std::max(1.0 - at(static_cast<float>(r * r)), 1e-5) * r * r * r);
  }
  lost_ = Distribution1D(lost);
}

float AlbedoTable::at(float cosine) const {
  const float x = std::sqrt(std::min(std::abs(cosine), 1.0f)) * (kKnots - 1);
  const int i = std::min(static_cast<int>(x), kKnots - 2);
  const float share = x - static_cast<float>(i);
  return values_[static_cast<std::size_t>(i)] * (1 - share) +
         values_[static_cast<std::size_t>(i) + 1] * share;
}

Vec3 AlbedoTable::sample_lost(const Vec2& u) const {
  float place = u.x;
  const std::size_t cell = lost_.sample(place);
  const float r = (static_cast<float>(cell) + place) / kLostCells;
  const float mu = r * r;
  const float sine = std::sqrt(std::max(0.0f, 1 - mu * mu));
  const float phi = 2 * kPi * u.y;
  return {sine * std::cos(phi), sine * std::sin(phi), mu};
}

float AlbedoTable::lost_pdf(float cosine) const {
  const float r = std::sqrt(std::max(cosine, 1e-12f));
  const auto cell = static_cast<std::size_t>(std::min(static_cast<int>(r * kLostCells), kLostCells - 1));
  return lost_.probability(cell) * kLostCells / (2 * r) / (2 * kPi);
}

}  // namespace vivify::render
