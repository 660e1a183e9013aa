// A picture of every kind of material and the commonest lights, compared with its golden; and a check that
// the comparison sees small mistakes in it.
#include "tests/render/golden.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/config.h"
#include "render/image_compare.h"
#include "render/render.h"
#include "tests/render/test_images.h"

namespace vivify::render {
namespace {

constexpr int kWidth = 64, kHeight = 36;

Value resolved(const Schema& schema, const std::string& yaml) {
  std::vector<Error> errors;
  const Value value = resolve(schema, parse_yaml(yaml, "test", errors), errors);
  for (const Error& error : errors) ADD_FAILURE() << error.full_text();
  return value;
}

Mesh ball(const std::string& material, const Eigen::Vector3d& center, double radius, int id) {
  constexpr int kRings = 12, kSectors = 24;
  Mesh mesh;
  mesh.name = material;
  mesh.part_materials = {material};
  mesh.object_id = id;
  mesh.V.resize((kRings + 1) * kSectors, 3);
  for (int r = 0; r <= kRings; ++r) {
    for (int s = 0; s < kSectors; ++s) {
      const double polar = std::numbers::pi * r / kRings, around = 2 * std::numbers::pi * s / kSectors;
      mesh.V.row(r * kSectors + s) =
          center + radius * Eigen::Vector3d(std::sin(polar) * std::sin(around), std::cos(polar),
                                            std::sin(polar) * std::cos(around));
    }
  }
  std::vector<Eigen::RowVector3i> faces;
  for (int r = 0; r < kRings; ++r) {
    for (int s = 0; s < kSectors; ++s) {
      const int a = r * kSectors + s, b = r * kSectors + (s + 1) % kSectors, c = a + kSectors,
                d = b + kSectors;
      if (r > 0) faces.emplace_back(a, d, b);
      if (r + 1 < kRings) faces.emplace_back(a, c, d);
    }
  }
  mesh.F.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) mesh.F.row(static_cast<Eigen::Index>(f)) = faces[f];
  return mesh;
}

Mesh floor_plate() {
  Mesh mesh;
  mesh.name = "floor";
  mesh.part_materials = {"floor"};
  mesh.object_id = 1;
  mesh.V.resize(4, 3);
  mesh.V << -6, 0, -6, -6, 0, 6, 6, 0, 6, 6, 0, -6;
  mesh.F.resize(2, 3);
  mesh.F << 0, 1, 2, 0, 2, 3;
  mesh.UV.resize(4, 2);
  mesh.UV << 0, 0, 0, 1, 1, 1, 1, 0;
  return mesh;
}

// What a wrong renderer may get wrong; 1, 0: nothing is.
struct Mistakes {
  double albedo = 1, light = 1, metal_roughness = 0.25, camera_shift = 0;
  int frame = 1, spp = 4;
};

Bytes picture(const Mistakes& mistakes = {}) {
  const auto grey = [](double v) {
    return "[" + std::to_string(v) + ", " + std::to_string(v) + ", " + std::to_string(v) + "]";
  };
  Looks looks;
  const auto material = [&](const std::string& name, const std::string& yaml) {
    looks.materials[name] = resolved(material_schema(), yaml);
  };
  material("floor", "{type: diffuse, color: " + grey(0.7 * mistakes.albedo) +
                        ", texture: {type: checker, scale: 10}}");
  material("porcelain", "{type: porcelain, color: [0.8, 0.3, 0.2], roughness: 0.1}");
  material("metal", "{type: metal, color: [1.0, 0.72, 0.33], roughness: " +
                        std::to_string(mistakes.metal_roughness) + "}");
  material("glass", "{type: glass}");
  material("diffuse", "{type: diffuse, color: [0.2, 0.5, 0.7]}");
  looks.lights.push_back(resolved(light_schema(), "{type: sky}"));
  looks.lights.push_back(resolved(
      light_schema(), "{type: area, position: [-3, 5, 3], target: [0, 0, 0], size: [2, 2], radiance: " +
                          std::to_string(15 * mistakes.light) + "}"));
  Frame frame;
  frame.number = mistakes.frame;
  frame.camera.position = {mistakes.camera_shift, 2.2, 6.0};
  frame.camera.target = {mistakes.camera_shift, 0.6, 0};
  frame.camera.fov_deg = 28;
  frame.camera.aperture_radius_m = 0.03;
  frame.meshes = {floor_plate(), ball("porcelain", {-2.1, 0.7, 0}, 0.7, 2),
                  ball("metal", {-0.7, 0.7, -0.6}, 0.7, 3), ball("glass", {0.7, 0.7, 0.4}, 0.7, 4),
                  ball("diffuse", {2.1, 0.7, -0.2}, 0.7, 5)};
  RenderSettings settings;
  settings.width = kWidth;
  settings.height = kHeight;
  settings.spp = mistakes.spp;
  return encode_exr(Renderer(looks).render(frame, settings));
}

TEST(Golden, Materials) { test::expect_golden("materials", picture()); }

TEST(Golden, SmallMistakesAreSeen) {
  const test::Folder folder;
  const auto image = [&](const Mistakes& mistakes) {
    write_file_atomic(folder / "picture.exr", picture(mistakes));
    return read_image(folder / "picture.exr");
  };
  const Image right = image({});
  EXPECT_TRUE(compare_images(right, image({}), {.exact = true}).same);
  const auto seen = [&](const Mistakes& mistakes) { return !compare_images(right, image(mistakes)).same; };
  EXPECT_TRUE(seen({.albedo = 1.01}));
  EXPECT_TRUE(seen({.light = 1.01}));
  EXPECT_TRUE(seen({.metal_roughness = 0.26}));
  EXPECT_TRUE(seen({.camera_shift = 0.01}));
  EXPECT_TRUE(seen({.frame = 2}));
  EXPECT_TRUE(seen({.spp = 8}));
}

}  // namespace
}  // namespace vivify::render
