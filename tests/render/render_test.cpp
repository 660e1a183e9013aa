// Whole pictures against closed forms and laws.
#include "render/render.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <atomic>
#include <cmath>

#include "common/parallel.h"
#include "render/materials/material.h"
#include "tests/render/render_support.h"

namespace vivify::render {
namespace {

using testing_support::ball;
using testing_support::box;
using testing_support::Estimate;
using testing_support::mean_radiance;
using testing_support::replicated;
using testing_support::settings;
using testing_support::square;
using Strategy = RenderSettings::Strategy;

// A scene that is put together in a line or two.
struct Scene {
  Looks looks;
  Frame frame;
  RenderSettings settings;

  Scene() {
    settings.width = settings.height = 8;
    settings.spp = 16;
    settings.splits = 1;
  }
  Scene& material(const std::string& name, const std::string& text) {
    looks.materials[name] = testing_support::settings(material_schema(), text);
    return *this;
  }
  Scene& light(const std::string& text) {
    looks.lights.push_back(testing_support::settings(light_schema(), text));
    return *this;
  }
  Scene& mesh(Mesh m) {
    frame.meshes.push_back(std::move(m));
    return *this;
  }
  Scene& camera(const Eigen::Vector3d& position, const Eigen::Vector3d& target, double fov_deg) {
    frame.camera.position = position;
    frame.camera.target = target;
    frame.camera.fov_deg = fov_deg;
    frame.camera.up = std::abs((target - position).normalized().y()) > 0.99 ? Eigen::Vector3d(0, 0, -1)
                                                                            : Eigen::Vector3d(0, 1, 0);
    return *this;
  }
  Film film() const { return Renderer(looks).render(frame, settings); }
  // Mean luminance over the picture, over replicates.
  Estimate estimate(int replicates = 16) const {
    const Renderer renderer(looks);
    return replicated(
        [&](std::uint64_t seed) {
          RenderSettings s = settings;
          s.seed = seed;
          return luminance(mean_radiance(renderer.render(frame, s)));
        },
        replicates);
  }
};

// The spot at the origin of a matt level square of reflectance 0.5, seen under a small angle.
Scene matt_square(const std::string& light) {
  Scene scene;
  scene.material("matt", "{type: diffuse, color: [0.5, 0.5, 0.5]}").light(light);
  scene.mesh(square({0, 0, 0}, 1, {0, 1, 0}, "matt")).camera({1.2, 1.6, 0}, {0, 0, 0}, 0.05);
  return scene;
}

void expect_value(const Scene& scene, double wanted) {
  const Estimate e = scene.estimate();
  // The floor is for what has no noise at all: rounding and the extent of the spot.
  EXPECT_NEAR(e.mean, wanted, 3 * e.standard_error + 2e-5 * wanted) << "standard error " << e.standard_error;
  EXPECT_LT(e.standard_error, 0.02 * wanted);
}

TEST(ClosedForm, SphereLight) {  // E = π L sin²σ for a ball overhead
  expect_value(matt_square("{type: sphere, position: [0, 2, 0], radius: 0.5, radiance: 8, visible: false}"),
               0.5 * 8 * 0.25 / 4);
}

TEST(ClosedForm, DiskLight) {  // E = π L r² / (r² + h²)
  expect_value(matt_square("{type: disk, position: [0, 1.5, 0], radius: 0.7, radiance: 3, visible: false}"),
               0.5 * 3 * 0.49 / (0.49 + 2.25));
}

TEST(ClosedForm,
     AreaLight) {  // four times the form factor from a point to a parallel rectangle above its corner
  const double a = 0.6 / 1.5, b = 0.4 / 1.5;
  const double quarter = (a / std::sqrt(1 + a * a) * std::atan(b / std::sqrt(1 + a * a)) +
                          b / std::sqrt(1 + b * b) * std::atan(a / std::sqrt(1 + b * b))) /
                         (2 * M_PI);
  expect_value(matt_square("{type: area, position: [0, 1.5, 0], target: [0, 0, 0], size: [1.2, 0.8], "
                           "radiance: 6, visible: false}"),
               0.5 * 6 * 4 * quarter);
}

TEST(ClosedForm, ShiningMesh) {  // the same rectangle (a square of half side 0.5) as triangles
  const double a = 0.5 / 1.5;
  const double quarter = 2 * (a / std::sqrt(1 + a * a) * std::atan(a / std::sqrt(1 + a * a))) / (2 * M_PI);
  Scene scene = matt_square("{type: environment, color: [0, 0, 0]}");
  scene.material("lamp", "{type: emissive, radiance: 6}").mesh(square({0, 1.5, 0}, 0.5, {0, -1, 0}, "lamp"));
  scene.camera({1.2, 1.0, 0}, {0, 0, 0}, 0.05);
  expect_value(scene, 0.5 * 6 * 4 * quarter);
}

TEST(ClosedForm, Sun) {
  expect_value(matt_square("{type: sun, elevation_deg: 30, angle_deg: 1, irradiance: 4, color: [1, 1, 1]}"),
               0.5 * 4 * 0.5 / M_PI);
}

TEST(ClosedForm,
     Sky) {  // two half skies: only the upper one lights a level square; cosine-weighted mean of √cos is 4/5
  expect_value(matt_square("{type: sky, zenith: [3, 3, 3], horizon: [1, 1, 1], ground: [9, 9, 9]}"),
               0.5 * (1 + 2 * 0.8));
}

// Inside a closed ball of reflectance ρ of which the share f shines with Le, the rest has ρ f Le / (1 − ρ (1
// − f)): every bounce of every order counts.
TEST(ClosedForm, IntegratingSphere) {
  Scene scene;
  Mesh mesh = ball({0, 0, 0}, 1, "wall", 64, true);
  mesh.part_materials = {"wall", "lamp"};
  mesh.face_part.setZero(mesh.F.rows());
  double lamp = 0, all = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Eigen::Vector3d a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)),
                          c = mesh.V.row(mesh.F(f, 2));
    const double area = (b - a).cross(c - a).norm();
    all += area;
    if ((a + b + c).y() / 3 > 0.8) {
      mesh.face_part[f] = 1;
      lamp += area;
    }
  }
  const double share = lamp / all;
  scene.material("wall", "{type: diffuse, color: [0.8, 0.8, 0.8]}")
      .material("lamp", "{type: emissive, radiance: 5}");
  scene.mesh(mesh).camera({0, 0, 0}, {0.3, -1, 0.2}, 40);
  scene.settings.max_depth = 200;
  scene.settings.spp = 64;
  const Estimate e = scene.estimate();
  const double wanted = 0.8 * share * 5 / (1 - 0.8 * (1 - share));
  EXPECT_NEAR(e.mean, wanted, 3 * e.standard_error + 1e-3 * wanted)
      << e.standard_error;  // the ball has 64 rings
  EXPECT_LT(e.standard_error, 0.01 * wanted);
}

// A pane between the camera and a lamp lets (1 − R)/(1 + R) of the light through, with all inner reflections.
TEST(ClosedForm, GlassPane) {
  Scene scene;
  scene.material("glass", "{type: glass, ior: 1.5}").material("lamp", "{type: emissive, radiance: 2}");
  scene.mesh(box({-1, -1, 0}, {1, 1, 0.1}, "glass")).mesh(square({0, 0, -1}, 5, {0, 0, 1}, "lamp"));
  scene.camera({0, 0, 3}, {0, 0, 0}, 0.1);
  scene.settings.max_depth = 50;
  scene.settings.spp = 1024;
  expect_value(scene, 2 * 0.96 / 1.04);
}

// A closed body without absorption cannot be seen in front of an even sky.
TEST(WhiteFurnace, BodiesVanish) {
  for (const MaterialEntry& entry : material_registry()) {
    for (const char* roughness : {"0.05", "0.3", "1"}) {
      std::string text = "{type: " + std::string(entry.name) + ", color: [1, 1, 1]";
      bool rough = false;
      for (const auto& field : entry.schema().fields) rough = rough || field.first == "roughness";
      if (rough) text += std::string(", roughness: ") + roughness;
      Scene scene;
      scene.material("body", text + "}").light("{type: environment}");
      scene.mesh(ball({0, 0, 0}, 1, "body", 24)).camera({0, 0, 4}, {0, 0, 0}, 30);
      scene.settings.width = scene.settings.height = 16;
      scene.settings.spp = 128;
      scene.settings.max_depth = 500;
      const Film film = scene.film();
      double sum = 0, covered = 0;
      for (std::size_t i = 0; i < film.pixels(); ++i) {
        if (film.rgba[4 * i + 3] < 1) continue;
        sum += film.rgba[4 * i + 1];
        covered += 1;
      }
      ASSERT_GT(covered, 50);
      EXPECT_NEAR(sum / covered, 1, 0.005) << text;
      if (!rough) break;
    }
  }
}

// A little of everything, with lights that both strategies can find.
Scene mixed_scene(const std::string& compensation) {
  Scene scene;
  scene.material("matt", "{type: diffuse, color: [0.6, 0.5, 0.4]}");
  scene.material("china", "{type: porcelain, color: [0.7, 0.7, 0.8], roughness: 0.3}");
  scene.material("metal", "{type: metal, color: [0.9, 0.7, 0.4], roughness: 0.4}");
  scene.material("frost", "{type: glass, roughness: 0.6, color: [0.9, 1, 0.9]}");
  scene.material("lamp", "{type: emissive, radiance: 3}");
  scene.light("{type: area, position: [-1, 3, 1], target: [0, 0, 0], size: [2, 2], radiance: 4}");
  scene.light("{type: sphere, position: [2, 2.2, 0], radius: 0.6, radiance: 3}");
  scene.light("{type: sky, mis_compensation: " + compensation + "}");
  scene.mesh(square({0, 0, 0}, 3, {0, 1, 0}, "matt", 1))
      .mesh(ball({-1.1, 0.6, 0}, 0.6, "china", 16, false, 2));
  scene.mesh(ball({0.2, 0.5, 0.4}, 0.5, "metal", 16, false, 3))
      .mesh(box({0.8, 0, -0.6}, {1.5, 0.9, 0.1}, "frost", 4));
  scene.mesh(square({0, 1.2, -2.5}, 0.7, {0, 0, 1}, "lamp", 5)).camera({0, 1.8, 4}, {0, 0.5, 0}, 40);
  scene.settings.width = 24;
  scene.settings.height = 16;
  scene.settings.spp = 64;
  scene.settings.max_depth = 4;
  return scene;
}

TEST(Path, StrategiesAgree) {
  Scene scene = mixed_scene("false");
  std::vector<Estimate> estimates;
  for (const Strategy strategy : {Strategy::mis, Strategy::lights_only, Strategy::bsdf_only}) {
    scene.settings.strategy = strategy;
    estimates.push_back(scene.estimate());
  }
  Scene compensated = mixed_scene("true");
  estimates.push_back(compensated.estimate());
  compensated.settings.splits = 4;
  compensated.settings.spp = 16;
  estimates.push_back(compensated.estimate());
  for (std::size_t i = 1; i < estimates.size(); ++i) {
    const double error = std::hypot(estimates[0].standard_error, estimates[i].standard_error);
    EXPECT_NEAR(estimates[i].mean, estimates[0].mean, 3 * error) << "estimate " << i;
    EXPECT_LT(error, 0.01 * estimates[0].mean);
  }
  // Together they are better than each alone.
  EXPECT_LT(estimates[0].standard_error, estimates[1].standard_error);
  EXPECT_LT(estimates[0].standard_error, estimates[2].standard_error);
}

TEST(Path, ClampOnlyTakesAway) {
  Scene scene = mixed_scene("true");
  const double whole = scene.estimate(4).mean;
  scene.settings.clamp = 0.1;
  const double clamped = scene.estimate(4).mean;
  EXPECT_LT(clamped, whole);
  EXPECT_GT(clamped, 0.5 * whole);
  scene.settings.clamp = 1e6;
  EXPECT_DOUBLE_EQ(scene.estimate(4).mean, whole);
}

// Wider mirrors throw no specks but the same light: more even, and nearly as bright.
TEST(Path, IndirectRoughnessKeepsTheLight) {
  Scene scene;
  scene.material("matt", "{type: diffuse, color: [0.5, 0.5, 0.5]}")
      .material("mirror", "{type: metal, color: [1, 1, 1], roughness: 0.1}");
  scene.light(
      "{type: area, position: [0, 3, 0], target: [0, 0, 0], size: [0.6, 0.6], radiance: 30, visible: false}");
  scene.mesh(square({0, 0, 0}, 2, {0, 1, 0}, "matt")).mesh(square({-2, 1, 0}, 1, {1, 0, 0}, "mirror"));
  scene.camera({0, 5, 0}, {0, 0, 0}, 40);
  scene.settings.spp = 64;
  scene.settings.max_depth = 3;
  const Estimate sharp = scene.estimate();
  scene.settings.indirect_roughness = 0.5;
  const Estimate blurred = scene.estimate();
  EXPECT_LT(blurred.standard_error, 0.5 * sharp.standard_error);
  EXPECT_NEAR(blurred.mean, sharp.mean, 0.05 * sharp.mean + 3 * sharp.standard_error);
}

bool same(const Film& a, const Film& b) {
  return a.rgba == b.rgba && a.albedo == b.albedo && a.normal == b.normal && a.depth == b.depth &&
         a.id == b.id;
}

TEST(Determinism, BitsDependOnSceneFrameAndSeedOnly) {
  Scene scene = mixed_scene("true");
  scene.settings.width = 70;  // several tiles, the last ones cut
  scene.settings.height = 37;
  scene.settings.spp = 4;
  scene.settings.splits = 2;
  scene.frame.camera.aperture_radius_m = 0.05;
  const Renderer renderer(scene.looks);
  set_thread_count(1);
  const Film one = renderer.render(scene.frame, scene.settings);
  set_thread_count(2);
  const Film two = renderer.render(scene.frame, scene.settings);
  set_thread_count(7);
  const Film seven = Renderer(scene.looks).render(scene.frame, scene.settings);
  set_thread_count(0);
  EXPECT_TRUE(same(one, two));
  EXPECT_TRUE(same(one, seven));
  EXPECT_EQ(encode_exr(one), encode_exr(seven));

  scene.frame.number = 2;
  EXPECT_FALSE(same(one, renderer.render(scene.frame, scene.settings)));
  scene.frame.number = 1;
  EXPECT_TRUE(same(one, renderer.render(scene.frame, scene.settings)));  // whatever was rendered in between
  scene.settings.seed = 1;
  EXPECT_FALSE(same(one, renderer.render(scene.frame, scene.settings)));
}

TEST(Determinism, NoiseOfFramesIsNotCorrelated) {
  Scene scene = matt_square(
      "{type: area, position: [1, 1, 0], target: [0, 0, 0], size: [2, 2], radiance: 1, visible: false}");
  scene.settings.width = scene.settings.height = 64;
  scene.settings.spp = 1;
  const Renderer renderer(scene.looks);
  const Film a = renderer.render(scene.frame, scene.settings);
  scene.frame.number = 2;
  const Film b = renderer.render(scene.frame, scene.settings);
  const auto green = [](const Film& film, std::size_t i) { return film.rgba[4 * i + 1]; };
  double ma = mean_radiance(a).y, mb = mean_radiance(b).y, ab = 0, aa = 0, bb = 0, neighbours = 0;
  for (std::size_t i = 0; i < a.pixels(); ++i) {
    ab += (green(a, i) - ma) * (green(b, i) - mb);
    aa += (green(a, i) - ma) * (green(a, i) - ma);
    bb += (green(b, i) - mb) * (green(b, i) - mb);
    if (i > 0) neighbours += (green(a, i) - ma) * (green(a, i - 1) - ma);
  }
  ASSERT_GT(aa, 0);
  const double limit = 4 / std::sqrt(double(a.pixels()));  // 4 standard errors of no correlation
  EXPECT_LT(std::abs(ab) / std::sqrt(aa * bb), limit);
  EXPECT_LT(std::abs(neighbours) / aa, limit);
}

TEST(Planes, OfABallBeforeTheSky) {
  Scene scene;
  scene.material("red", "{type: diffuse, color: [0.8, 0.1, 0.2]}")
      .light("{type: environment, strength: 0.5}");
  Mesh mesh = ball({0, 0, 0}, 1, "red", 64, false, 7);
  mesh.smooth = true;
  scene.mesh(mesh).camera({0, 0, 5}, {0, 0, 0}, 40);
  scene.settings.width = scene.settings.height = 33;
  const Film film = scene.film();
  const std::size_t middle = 16 * 33 + 16, corner = 0;
  EXPECT_NEAR(film.depth[middle], 4, 0.01);
  EXPECT_EQ(film.depth[corner], 0);
  EXPECT_EQ(film.id[middle], 7);
  EXPECT_EQ(film.id[corner], 0);
  EXPECT_FLOAT_EQ(film.rgba[4 * middle + 3], 1);
  EXPECT_FLOAT_EQ(film.rgba[4 * corner + 3], 0);
  EXPECT_FLOAT_EQ(film.rgba[4 * corner], 0.5f);
  EXPECT_NEAR(film.albedo[3 * middle], 0.8f, 1e-5f);
  EXPECT_EQ(film.albedo[3 * corner], 0);
  EXPECT_NEAR(film.normal[3 * middle + 2], 1, 0.01f);
  const std::size_t upper = 9 * 33 + 16;  // above the middle: the normal leans up
  const double y = std::tan(20 * M_PI / 180) * (1 - 2 * 9.5 / 33);
  const double t = (5 - std::sqrt(25 - 24 * (1 + y * y))) / (1 + y * y);
  EXPECT_NEAR(film.normal[3 * upper + 1], y * t, 0.01);
  EXPECT_NEAR(film.depth[upper], t * std::sqrt(1 + y * y), 0.01);
  // Coverage is the share of the picture that the ball takes.
  double coverage = 0;
  for (std::size_t i = 0; i < film.pixels(); ++i) coverage += film.rgba[4 * i + 3];
  const double radius = std::tan(std::asin(0.2)) / std::tan(20 * M_PI / 180) / 2;
  EXPECT_NEAR(coverage / double(film.pixels()), M_PI * radius * radius, 0.003);
}

TEST(Planes, DefocusBlursEdges) {
  Scene scene;
  scene.material("black", "{type: diffuse, color: [0, 0, 0]}").light("{type: environment}");
  scene.mesh(square({10, 0, 0}, 10, {0, 0, 1}, "black"))
      .camera({0, 0, 4}, {0, 0, 0}, 40);  // covers the right half
  scene.settings.width = 64;
  scene.settings.height = 8;
  scene.settings.spp = 256;
  const auto width = [&](double focus) {  // of the edge, in pixels: pixels that are neither covered nor free
    scene.frame.camera.aperture_radius_m = 0.4;
    scene.frame.camera.focus_m = focus;
    const Film film = scene.film();
    int between = 0;
    for (std::size_t x = 0; x < 64; ++x) {
      const float a = film.rgba[4 * (4 * 64 + x) + 3];
      between += a > 0 && a < 1 ? 1 : 0;
    }
    return between;
  };
  EXPECT_LE(width(4), 2);
  // Out of focus: radius r |1 − d/f| at distance d = 4, over the size of a pixel there.
  const double pixel = 2 * 4 * std::tan(20 * M_PI / 180) / 8;
  EXPECT_NEAR(width(8), 2 * 0.4 * 0.5 / pixel + 2, 2);
}

TEST(Light, CanBeHiddenFromTheCameraOnly) {
  Scene scene = matt_square("{type: sphere, position: [0, 2, 0], radius: 0.5, radiance: 8}");
  scene.camera({0, 1, 0}, {0, 2, 0}, 5);
  EXPECT_FLOAT_EQ(mean_radiance(scene.film()).x, 8);
  scene.looks.lights = {settings(
      light_schema(), "{type: sphere, position: [0, 2, 0], radius: 0.5, radiance: 8, visible: false}")};
  EXPECT_EQ(mean_radiance(scene.film()).x, 0);
}

TEST(Renderer, ReportsProgressAndEmptyScenes) {
  Scene scene;
  scene.settings.width = 40;
  scene.settings.height = 20;
  std::vector<double> shares;
  const Film film =
      Renderer(scene.looks).render(scene.frame, scene.settings, [&](double s) { shares.push_back(s); });
  EXPECT_EQ(mean_radiance(film), Vec3());
  ASSERT_EQ(shares.size(), 6u);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.back(), 1);
}

}  // namespace
}  // namespace vivify::render
