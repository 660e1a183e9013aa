// GGX microfacets, isotropic, with height-correlated shadowing [Walter et al. 2007; Heitz 2014], and Fresnel
// factors.
#pragma once

#include "render/vec.h"

namespace vivify::render {

// Roughness of the scene file to the width α of the distribution. Below kMirrorRoughness a surface counts as
// smooth.
constexpr double kMirrorRoughness = 0.05;
constexpr float alpha_of(float roughness) { return roughness * roughness; }

// All directions are on the upper side (z > 0).
class Ggx {
 public:
  explicit Ggx(float alpha) : alpha_(alpha), alpha2_(alpha * alpha) {}

  float density(const Vec3& m) const {  // D(m)
    const float d = (m.x * m.x + m.y * m.y) / alpha2_ + m.z * m.z;
    return 1 / (kPi * alpha2_ * d * d);
  }
  float lambda(const Vec3& w) const {
    const float tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
    return 0.5f * (std::sqrt(1 + alpha2_ * tan2) - 1);
  }
  float g1(const Vec3& w) const { return 1 / (1 + lambda(w)); }
  float g2(const Vec3& a, const Vec3& b) const { return 1 / (1 + lambda(a) + lambda(b)); }

  // A normal seen from wo, with density G1(wo) D(m) max(0, wo·m) / cos θo [Dupuy and Benyoub 2023].
  Vec3 sample_normal(const Vec3& wo, const Vec2& u) const {
    const Vec3 stretched = normalize(Vec3(wo.x * alpha_, wo.y * alpha_, wo.z));
    const float phi = 2 * kPi * u.x;
    const float z = (1 - u.y) * (1 + stretched.z) - stretched.z;
    const float r = std::sqrt(std::max(0.0f, 1 - z * z));
    const Vec3 h = Vec3(r * std::cos(phi), r * std::sin(phi), z) + stretched;
    return normalize(Vec3(h.x * alpha_, h.y * alpha_, std::max(1e-7f, h.z)));
  }
  float normal_pdf(const Vec3& wo, const Vec3& m) const {
    return g1(wo) * density(m) * std::max(0.0f, dot(wo, m)) / wo.z;
  }

 private:
  float alpha_, alpha2_;
};

inline Vec3 reflect(const Vec3& w, const Vec3& m) { return 2 * dot(w, m) * m - w; }

// Refraction of w (on the side of m) by relative index eta = n_below / n_above; false: total reflection.
inline bool refract(const Vec3& w, const Vec3& m, float eta, Vec3& refracted) {
  const float c = dot(w, m);
  const float sin2 = std::max(0.0f, 1 - c * c) / (eta * eta);
  if (sin2 >= 1) return false;
  refracted = (c / eta - std::sqrt(1 - sin2)) * m - w / eta;
  return true;
}

// Unpolarised reflectance of a dielectric for cos θ >= 0, eta as above.
inline float fresnel_dielectric(float cosine, float eta) {
  const float c = std::clamp(cosine, 0.0f, 1.0f);
  const float sin2 = (1 - c * c) / (eta * eta);
  if (sin2 >= 1) return 1;
  const float t = std::sqrt(1 - sin2);
  const float parallel = (eta * c - t) / (eta * c + t);
  const float perpendicular = (c - eta * t) / (c + eta * t);
  return 0.5f * (parallel * parallel + perpendicular * perpendicular);
}

// Schlick's reflectance of a conductor with reflectance f0 at normal incidence.
inline Vec3 fresnel_schlick(float cosine, const Vec3& f0) {
  const float c = 1 - std::clamp(cosine, 0.0f, 1.0f);
  const float c2 = c * c;
  return f0 + (Vec3(1) - f0) * (c2 * c2 * c);
}

}  // namespace vivify::render
