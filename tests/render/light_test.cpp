// Laws that every light of the registry keeps; a new one is tested without a new test.
#include "render/lights/light.h"

#include <gtest/gtest.h>

#include "common/rng.h"
#include "render/lights/dome.h"
#include "render/sampler.h"
#include "render/warp.h"
#include "render/world.h"
#include "tests/render/render_support.h"

namespace vivify::render {
namespace {

using testing_support::direction_fit;
using testing_support::goodness_of_fit;
using testing_support::settings;
using testing_support::sidak;
using testing_support::square;

std::unique_ptr<Light> light(const std::string& text) {
  return make_light(settings(light_schema(), text), "");
}

// Settings that give each light of the registry a large, off-centre shape as seen from the points below.
std::string example(std::string_view name) {
  std::string text = "{type: " + std::string(name);
  for (const LightEntry& entry : light_registry()) {
    if (entry.name != name) continue;
    for (const auto& [key, schema] : entry.schema().fields) {
      if (key == "position") text += ", position: [0.3, 2, -0.4]";
      if (key == "target") text += ", target: [0, 0, 0.2]";
      if (key == "size") text += ", size: [2.5, 1.2]";
      if (key == "radius") text += ", radius: 0.9";
      if (key == "angle_deg") text += ", angle_deg: 40";
      if (key == "heading_deg") text += ", heading_deg: 33";
      if (key == "mis_compensation") text += ", mis_compensation: false";
    }
  }
  return text + "}";
}

const std::vector<Vec3> kPoints = {{0, 0, 0}, {1.5f, 0.7f, 0.6f}, {-0.5f, -3, 1}};

TEST(Light, SamplesFollowTheirDensity) {
  const int tests = static_cast<int>(light_registry().size() * kPoints.size());
  std::uint64_t seed = 0;
  for (const LightEntry& entry : light_registry()) {
    const auto l = light(example(entry.name));
    for (const Vec3& p : kPoints) {
      // Cells around the mean direction, no wider than the light.
      CounterRng rng(++seed);
      Vec3 axis;
      std::vector<Vec3> seen;
      for (int s = 0; s < 2000; ++s) {
        LightSample sample;
        ASSERT_TRUE(
            l->sample(p, {static_cast<float>(rng.uniform()), static_cast<float>(rng.uniform())}, sample))
            << entry.name;
        axis += sample.direction;
        seen.push_back(sample.direction);
      }
      float least = 1;
      for (const Vec3& d : seen) least = std::min(least, dot(normalize(axis), d));
      least = std::max(-1.0f, 1 - 1.1f * (1 - least));
      double integral = 0;
      const double fit = direction_fit(
          [&](const Vec2& u, float, Vec3& d) {
            LightSample sample;
            if (!l->sample(p, u, sample)) return false;
            d = sample.direction;
            return true;
          },
          [&](const Vec3& d) {
            return is_zero(l->radiance({p, d})) ? 0 : l->pdf(p, d);
          },
          axis, least, ++seed, &integral);
      EXPECT_GT(fit, sidak(tests)) << entry.name << " integral " << integral;
      EXPECT_NEAR(integral, 1, 3e-3) << entry.name;
    }
  }
}

TEST(Light, SampleAgreesWithPdfRadianceAndDistance) {
  for (const LightEntry& entry : light_registry()) {
    const auto l = light(example(entry.name));
    CounterRng rng(3);
    for (const Vec3& p : kPoints) {
      EXPECT_GT(l->importance(p), 0) << entry.name;
      for (int s = 0; s < 500; ++s) {
        LightSample sample;
        ASSERT_TRUE(l->sample(
            p, {static_cast<float>(rng.uniform(0.001, 0.999)), static_cast<float>(rng.uniform(0.001, 0.999))},
            sample));
        EXPECT_NEAR(sample.pdf, l->pdf(p, sample.direction), 2e-3f * sample.pdf) << entry.name;
        const Vec3 beyond = l->radiance({p, sample.direction, sample.distance * 1.001f});
        EXPECT_NEAR(beyond.y, sample.radiance.y, 1e-3f * sample.radiance.y) << entry.name;
        if (sample.distance < 1e30f) {
          EXPECT_TRUE(is_zero(l->radiance({p, sample.direction, sample.distance * 0.999f}))) << entry.name;
        }
      }
    }
  }
}

// The irradiance found by sampling is the one found by looking in all directions.
TEST(Light, IrradianceDoesNotDependOnTheStrategy) {
  for (const LightEntry& entry : light_registry()) {
    const auto l = light(example(entry.name));
    const Vec3 p = kPoints[0];
    double by_light = 0, by_hemisphere = 0;
    constexpr std::uint32_t kSamples = 1u << 16;
    Sampler sampler(9, kSamples);
    for (std::uint32_t s = 0; s < kSamples; ++s) {
      sampler.start(s);
      const auto u = sampler.next();
      LightSample sample;
      if (l->sample(p, {u[0], u[1]}, sample)) {
        by_light += std::max(0.0f, sample.direction.y) * luminance(sample.radiance) / sample.pdf;
      }
      const Vec3 d = Basis({0, 1, 0}).to_world(sample_cosine_hemisphere({u[2], u[3]}));
      by_hemisphere += luminance(l->radiance({p, d})) * kPi;
    }
    EXPECT_NEAR(by_light / kSamples, by_hemisphere / kSamples, 0.01 * by_hemisphere / kSamples) << entry.name;
  }
}

TEST(Light, ShinesToOneSideOnly) {
  for (const char* name : {"area", "disk"}) {
    const auto l = light(example(name));
    LightSample sample;
    EXPECT_FALSE(l->sample({0.3f, 5, -0.4f}, {0.5f, 0.5f}, sample));
    EXPECT_EQ(l->importance({0.3f, 5, -0.4f}), 0);
    EXPECT_TRUE(is_zero(l->radiance({{0.3f, 5, -0.4f}, {0, -1, 0}})));
  }
}

TEST(Light, FarAreaLightKeepsItsDigits) {
  const auto l =
      light("{type: area, position: [0, 1000, 0], target: [0, 0, 0], size: [0.5, 0.5], radiance: 1}");
  double sum = 0;
  CounterRng rng(8);
  for (int s = 0; s < 1000; ++s) {
    LightSample sample;
    ASSERT_TRUE(
        l->sample({}, {static_cast<float>(rng.uniform()), static_cast<float>(rng.uniform())}, sample));
    EXPECT_NEAR(sample.pdf, l->pdf({}, sample.direction), 1e-3f * sample.pdf);
    sum += sample.direction.y / sample.pdf;
  }
  EXPECT_NEAR(sum / 1000, 0.25e-6, 1e-9);
}

TEST(Light, SunGivesItsIrradiance) {
  const auto sun = light("{type: sun, elevation_deg: 90, angle_deg: 0.53, irradiance: 3, color: [1, 1, 1]}");
  double sum = 0;
  CounterRng rng(2);
  for (int s = 0; s < 4000; ++s) {
    LightSample sample;
    ASSERT_TRUE(
        sun->sample({}, {static_cast<float>(rng.uniform()), static_cast<float>(rng.uniform())}, sample));
    EXPECT_FALSE(is_zero(sun->radiance({{}, sample.direction})));
    sum += sample.radiance.y * sample.direction.y / sample.pdf;
  }
  EXPECT_NEAR(sum / 4000, 3, 1e-3);
}

// A picture with one bright spot, and its orientation: the top is +y, the middle looks to −z, the right is
// +x.
TEST(Light, DomeSamplesAPictureByItsBrightness) {
  Picture picture{64, 32, std::vector<Vec3>(64 * 32, Vec3(0.1f))};
  picture.texels[8 * 64 + 40] = Vec3(5000);
  const DomeLight dome(picture, 0, true, false);
  const float theta = kPi * 8.5f / 32, phi = 2 * kPi * (40.5f / 64 - 0.5f);
  const Vec3 spot = {std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi)};
  EXPECT_NEAR(dome.radiance({{}, spot}).x, 5000, 10);
  EXPECT_GT(spot.x, 0);
  double integral = 0;
  const double fit = direction_fit(
      [&](const Vec2& u, float, Vec3& d) {
        LightSample sample;
        if (!dome.sample({}, u, sample)) return false;
        d = sample.direction;
        return true;
      },
      [&](const Vec3& d) { return dome.pdf({}, d); }, {0, 1, 0}, -1, 77, &integral);
  EXPECT_GT(fit, sidak(2));
  EXPECT_NEAR(integral, 1, 3e-3);
  int near = 0;
  CounterRng rng(4);
  for (int s = 0; s < 1000; ++s) {
    LightSample sample;
    ASSERT_TRUE(
        dome.sample({}, {static_cast<float>(rng.uniform()), static_cast<float>(rng.uniform())}, sample));
    near += dot(sample.direction, spot) > 0.95f ? 1 : 0;
  }
  EXPECT_GT(near, 900);
}

TEST(Light, EvenDomeIsLeftToTheMaterials) {
  const auto even = light("{type: environment}");
  LightSample sample;
  EXPECT_FALSE(even->sample({}, {0.3f, 0.6f}, sample));
  EXPECT_EQ(even->pdf({}, {0, 1, 0}), 0);
  EXPECT_EQ(even->importance({}), 0);
  EXPECT_EQ(even->radiance({{}, {0, 1, 0}}).x, 1);
}

TEST(Light, ChoiceFollowsItsProbabilities) {
  std::vector<std::unique_ptr<Light>> owned;
  std::vector<const Light*> lights;
  for (const LightEntry& entry : light_registry()) {
    owned.push_back(light(example(entry.name)));
    lights.push_back(owned.back().get());
  }
  const World world({}, {}, {}, {}, lights);
  constexpr int kSamples = 50000;
  for (const Vec3& p : kPoints) {
    LightChoice choice;
    choice.update(world, p);
    std::vector<double> counts(lights.size()), expected;
    std::vector<double> places(20);
    double total = 0;
    for (std::size_t i = 0; i < lights.size(); ++i) {
      expected.push_back(kSamples * choice.probability(i));
      total += choice.probability(i);
      EXPECT_GE(choice.probability(i), 0.1f / static_cast<float>(lights.size()));
    }
    EXPECT_NEAR(total, 1, 1e-5);
    CounterRng rng(21);
    for (int s = 0; s < kSamples; ++s) {
      float u = static_cast<float>(rng.uniform());
      const int i = choice.sample(u);
      ASSERT_GE(i, 0);
      counts[static_cast<std::size_t>(i)] += 1;
      places[static_cast<std::size_t>(u * 20)] += 1;
    }
    EXPECT_GT(goodness_of_fit(counts, expected), sidak(6));
    EXPECT_GT(goodness_of_fit(places, std::vector<double>(20, kSamples / 20.0)), sidak(6));
  }
}

TEST(Light, ShiningTrianglesFollowTheirDensity) {
  const auto bright = make_material(settings(material_schema(), "{type: emissive, radiance: 3}"), "");
  const auto dim = make_material(settings(material_schema(), "{type: emissive, radiance: 1}"), "");
  const std::vector<Mesh> meshes = {square({0.5, 2, 0}, 0.8, {0, -1, 0}, "bright"),
                                    square({-1.5, 2, 0.3}, 0.9, {0.4, -1, 0}, "dim")};
  const World world(meshes, {{"bright", 0}, {"dim", 1}}, {bright.get(), dim.get()}, {bright.get(), dim.get()},
                    {});
  ASSERT_FALSE(world.emitters.empty());
  const Vec3 p = {0.2f, 0, 0.1f};
  double integral = 0;
  const double fit = direction_fit(
      [&](const Vec2& u, float, Vec3& d) {
        LightSample sample;
        if (!world.emitters.sample(p, u, sample)) return false;
        d = sample.direction;
        return true;
      },
      [&](const Vec3& d) {
        const Ray ray = {p, d};
        const Hit hit = world.accel.intersect(ray);
        if (!hit) return 0.0;
        const Surface s = world.geometry.surface(hit, ray);
        return double(world.emitters.triangle_pdf(hit.triangle, hit.t, s.front ? -dot(d, s.geometric) : 0));
      },
      {0, 1, 0}, 0, 31, &integral);
  EXPECT_GT(fit, 0.01);
  EXPECT_NEAR(integral, 1, 3e-3);
}

TEST(Light, RefusesWhatCannotShine) {
  EXPECT_THROW(light("{type: area, position: [0, 1, 0], target: [0, 1, 0]}"), Error);
  EXPECT_THROW(light("{type: area, position: [0, 1, 0], size: [0, 1]}"), Error);
}

}  // namespace
}  // namespace vivify::render
