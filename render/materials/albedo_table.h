// Directional albedo of a lobe, tabulated over the cosine: what makes rough materials keep all light.
#pragma once

#include <functional>
#include <vector>

#include "render/vec.h"
#include "render/warp.h"

namespace vivify::render {

class AlbedoTable {
 public:
  AlbedoTable() = default;
  // `weight(wo, u)` is f cos / pdf of the lobe for the direction sampled with u, 0 when it is lost; its mean
  // is the albedo.
  explicit AlbedoTable(const std::function<float(const Vec3& wo, const Vec2& u)>& weight);

  float at(float cosine) const;               // E(|cos θ|)
  float average() const { return average_; }  // 2 ∫ E(μ) μ dμ

  // A direction on the upper side, about in proportion to the light (1 − E(cos θ)) cos θ that is lost, and
  // its density.
  Vec3 sample_lost(const Vec2& u) const;
  float lost_pdf(float cosine) const;

 private:
  std::vector<float> values_;  // at cos θ = (i / (n − 1))²
  float average_ = 0;
  Distribution1D lost_;  // over cells of √cos θ
};

}  // namespace vivify::render
