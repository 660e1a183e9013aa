// Laws that every material of the registry keeps; a new one is tested without a new test.
#include "render/materials/material.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/rng.h"
#include "render/sampler.h"
#include "tests/render/render_support.h"

namespace vivify::render {
namespace {

using testing_support::direction_fit;
using testing_support::settings;
using testing_support::sidak;

struct Case {
  std::string text;
  std::unique_ptr<Material> material;
};

// Every material with a colour of `color`, at several roughnesses where it has one.
std::vector<Case> cases(const std::string& color, const std::vector<std::string>& roughnesses) {
  std::vector<Case> all;
  for (const MaterialEntry& entry : material_registry()) {
    const Schema schema = entry.schema();
    const bool rough = std::any_of(schema.fields.begin(), schema.fields.end(),
                                   [](const auto& field) { return field.first == "roughness"; });
    for (const std::string& roughness : rough ? roughnesses : std::vector<std::string>{""}) {
      const std::string text = "{type: " + std::string(entry.name) + ", color: " + color +
                               (rough ? ", roughness: " + roughness : "") + "}";
      all.push_back({text, make_material(settings(material_schema(), text), "")});
    }
  }
  return all;
}

Vec3 direction(float cosine, float phi) {
  const float r = std::sqrt(1 - cosine * cosine);
  return {r * std::cos(phi), r * std::sin(phi), cosine};
}

const std::vector<float> kCosines = {0.02f, 0.1f, 0.3f, 0.6f, 0.9f, 1.0f, -0.05f, -0.5f, -0.97f};

// Reflected and emitted light add up to the light of the surroundings: 1 everywhere.
TEST(Material, WhiteFurnace) {
  constexpr std::uint32_t kSamples = 8192;
  double worst = 0;
  for (const Case& c : cases("[1, 1, 1]", {"0.05", "0.1", "0.2", "0.35", "0.5", "0.75", "1"})) {
    for (const float cosine : kCosines) {
      double sum = 0;
      Sampler sampler(11, kSamples);
      for (std::uint32_t s = 0; s < kSamples; ++s) {
        sampler.start(s);
        const auto u = sampler.next();
        BsdfSample sample;
        if (c.material->sample(Vec3(1), direction(cosine, 0.4f), {u[0], u[1], u[2]}, sample))
          sum += sample.weight.y;
      }
      const double radiance = sum / kSamples + (cosine > 0 ? c.material->emission(Vec3(1)).y : 0);
      const bool black_back =
          cosine < 0 && !is_zero(c.material->emission(Vec3(1)));  // shines on one side only
      if (!black_back) {
        EXPECT_NEAR(radiance, 1, 0.005) << c.text << " cos θ " << cosine;
        worst = std::max(worst, std::abs(radiance - 1));
      }
    }
  }
  RecordProperty("worst", std::to_string(worst));
}

TEST(Material, AbsorbsWhatItsColourSays) {
  constexpr std::uint32_t kSamples = 4096;
  for (const Case& c : cases("[0.2, 0.5, 0.9]", {"0.1", "0.4", "1"})) {
    for (const float cosine : kCosines) {
      Vec3 sum;
      Sampler sampler(12, kSamples);
      for (std::uint32_t s = 0; s < kSamples; ++s) {
        sampler.start(s);
        const auto u = sampler.next();
        BsdfSample sample;
        if (c.material->sample({0.2f, 0.5f, 0.9f}, direction(cosine, 1), {u[0], u[1], u[2]}, sample))
          sum += sample.weight;
      }
      const Vec3 albedo = sum / kSamples;
      EXPECT_LE(max_component(albedo), 1.005f) << c.text;
      EXPECT_LE(albedo.x, albedo.y + 0.005f) << c.text;
      EXPECT_LE(albedo.y, albedo.z + 0.005f) << c.text;
    }
  }
}

TEST(Material, SamplesFollowTheirDensity) {
  const std::vector<Case> all = cases("[0.8, 0.6, 0.4]", {"0.15", "0.35", "0.7", "1"});
  std::vector<std::pair<const Case*, float>> tests;
  for (const Case& c : all) {
    if (c.material->is_delta() || !is_zero(c.material->emission(Vec3(1)))) continue;
    for (const float cosine : {0.1f, 0.7f, -0.4f}) tests.push_back({&c, cosine});
  }
  std::uint64_t seed = 100;
  for (const auto& [c, cosine] : tests) {
    const Vec3 color = {0.8f, 0.6f, 0.4f};
    const Vec3 wo = direction(cosine, 2);
    double integral = 0;
    const double p = direction_fit(
        [&](const Vec2& u, float v, Vec3& d) {
          BsdfSample sample;
          if (!c->material->sample(color, wo, {u.x, u.y, v}, sample)) return false;
          d = sample.wi;
          return true;
        },
        [&](const Vec3& wi) { return c->material->evaluate(color, wo, wi).pdf; }, {0, 0, 1}, -1, ++seed,
        &integral, 60000);
    EXPECT_GT(p, sidak(static_cast<int>(tests.size())))
        << c->text << " cos θ " << cosine << " integral " << integral;
    EXPECT_GT(integral, 0.6) << c->text;  // the rest is lost below the horizon, counted by the test as a cell
  }
}

TEST(Material, SampleAgreesWithEvaluate) {
  CounterRng rng(5);
  const Vec3 color = {0.8f, 0.6f, 0.4f};
  for (const Case& c : cases("[0.8, 0.6, 0.4]", {"0.05", "0.2", "0.6", "1"})) {
    int drawn = 0;
    for (int s = 0; s < 2000; ++s) {
      const Vec3 wo =
          direction(static_cast<float>(rng.uniform(-1, 1)), static_cast<float>(rng.uniform(0, 6)));
      BsdfSample sample;
      const Vec3 u = {static_cast<float>(rng.uniform()), static_cast<float>(rng.uniform()),
                      static_cast<float>(rng.uniform())};
      if (!c.material->sample(color, wo, u, sample) || sample.delta) continue;
      ++drawn;
      const BsdfValue f = c.material->evaluate(color, wo, sample.wi);
      ASSERT_NEAR(f.pdf, sample.pdf, 2e-3f * sample.pdf) << c.text;
      ASSERT_NEAR(f.value.y, sample.weight.y * sample.pdf, 2e-3f * f.value.y + 1e-6f) << c.text;
      ASSERT_TRUE(is_finite(sample.weight)) << c.text;
    }
    if (!c.material->is_delta() && is_zero(c.material->emission(Vec3(1)))) {
      EXPECT_GT(drawn, 1000) << c.text;
    }
  }
}

TEST(Material, IsReciprocalWhereItSaysSo) {
  CounterRng rng(6);
  int reciprocal = 0;
  for (const Case& c : cases("[0.8, 0.6, 0.4]", {"0.1", "0.5", "1"})) {
    if (!c.material->is_reciprocal()) continue;
    ++reciprocal;
    for (int s = 0; s < 500; ++s) {
      const Vec3 a =
          direction(static_cast<float>(rng.uniform(0.05, 1)), static_cast<float>(rng.uniform(0, 6)));
      const Vec3 b =
          direction(static_cast<float>(rng.uniform(0.05, 1)), static_cast<float>(rng.uniform(0, 6)));
      const Vec3 color = {0.8f, 0.6f, 0.4f};
      const float ab = c.material->evaluate(color, a, b).value.y / b.z;
      const float ba = c.material->evaluate(color, b, a).value.y / a.z;
      ASSERT_NEAR(ab, ba, 1e-3f * std::max(ab, 1e-3f)) << c.text;
    }
  }
  EXPECT_GE(reciprocal, 5);
}

// Clear glass: shares and directions of Fresnel and Snell.
TEST(Material, ClearGlassReflectsAndRefracts) {
  const auto glass = make_material(settings(material_schema(), "{type: glass, ior: 1.5}"), "");
  ASSERT_TRUE(glass->is_delta());
  BsdfSample sample;
  const Vec3 straight = {0, 0, 1};
  int reflected = 0;
  for (int i = 0; i < 10000; ++i) {
    ASSERT_TRUE(
        glass->sample(Vec3(1), straight, {0.5f, 0.5f, (static_cast<float>(i) + 0.5f) / 10000}, sample));
    reflected += sample.wi.z > 0 ? 1 : 0;
    EXPECT_FLOAT_EQ(sample.weight.x, 1);
  }
  EXPECT_NEAR(reflected, 400, 1);  // ((1.5 − 1)/(1.5 + 1))² = 4 %
  const Vec3 slanted = direction(std::sqrt(0.5f), 0);
  ASSERT_TRUE(glass->sample(Vec3(1), slanted, {0, 0, 0.99f}, sample));
  EXPECT_NEAR(sample.wi.x, -slanted.x / 1.5f, 1e-6f);
  EXPECT_LT(sample.wi.z, 0);
  const Vec3 inside = direction(-0.5f, 0);  // beyond the critical angle of 41.8°
  ASSERT_TRUE(glass->sample(Vec3(1), inside, {0, 0, 0.999f}, sample));
  EXPECT_LT(sample.wi.z, 0);
}

}  // namespace
}  // namespace vivify::render
