#include "render/lights/emitters.h"

#include <utility>

namespace vivify::render {

TriangleEmitters::TriangleEmitters(std::vector<Emitter> emitters, std::size_t triangle_count)
    : emitters_(std::move(emitters)) {
  if (emitters_.empty()) return;
  emitter_of_.assign(triangle_count, -1);
  std::vector<double> weights;
  Vec3 sum;
  for (std::size_t i = 0; i < emitters_.size(); ++i) {
    const auto& c = emitters_[i].corners;
    const double area = 0.5 * length(cross(c[1] - c[0], c[2] - c[0]));
    weights.push_back(area * luminance(emitters_[i].radiance));
    pdf_area_.push_back(area > 0 ? static_cast<float>(1 / area) : 0);
    emitter_of_[emitters_[i].triangle] = static_cast<std::int32_t>(i);
    sum += c[0] + c[1] + c[2];
  }
  choice_ = Distribution1D(weights);
  power_ = static_cast<float>(choice_.total());
  center_ = sum / static_cast<float>(3 * emitters_.size());
  for (std::size_t i = 0; i < emitters_.size(); ++i) {
    pdf_area_[i] *= choice_.probability(i);
    for (const Vec3& c : emitters_[i].corners) radius2_ = std::max(radius2_, length2(c - center_));
  }
}

float TriangleEmitters::importance(const Vec3& p) const {
  return emitters_.empty() ? 0 : power_ / (length2(p - center_) + radius2_);
}

bool TriangleEmitters::sample(const Vec3& p, const Vec2& u, LightSample& sample) const {
  if (power_ <= 0) return false;
  float first = u.x;
  const std::size_t i = choice_.sample(first);
  const auto& c = emitters_[i].corners;
  const float root = std::sqrt(first);
  const Vec3 at = c[0] * (1 - root) + c[1] * (root * (1 - u.y)) + c[2] * (root * u.y);
  const Vec3 way = at - p;
  const float r2 = length2(way);
  if (r2 == 0) return false;
  sample.distance = std::sqrt(r2);
  sample.direction = way / sample.distance;
  const float cosine = -dot(normalize(cross(c[1] - c[0], c[2] - c[0])), sample.direction);
  if (cosine <= 0) return false;
  sample.radiance = emitters_[i].radiance;
  sample.pdf = pdf_area_[i] * r2 / cosine;
  return sample.pdf > 0;
}

float TriangleEmitters::triangle_pdf(std::uint32_t triangle, float distance, float cosine) const {
  if (emitters_.empty() || emitter_of_[triangle] < 0 || cosine <= 0) return 0;
  return pdf_area_[static_cast<std::size_t>(emitter_of_[triangle])] * distance * distance / cosine;
}

}  // namespace vivify::render
