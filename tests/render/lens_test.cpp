#include "render/lens.h"

#include <gtest/gtest.h>

#include "common/error.h"
#include "common/rng.h"

namespace vivify::render {
namespace {

Camera camera(double radius, double focus) {
  Camera c;
  c.position = {1, 2, 3};
  c.target = {1, 2, -7};
  c.fov_deg = 40;
  c.aperture_radius_m = radius;
  c.focus_m = focus;
  return c;
}

// Where a ray meets the plane at a distance in front of the camera (which looks along −z).
Vec3 at_depth(const Ray& ray, float depth) {
  return ray.origin + ray.direction * ((3 - depth - ray.origin.z) / ray.direction.z);
}

TEST(Lens, AngleOfView) {
  const Lens lens(camera(0, 0), 160, 90);
  const auto angle = [](const Ray& ray) {
    return std::atan2(std::hypot(ray.direction.x, ray.direction.y), -ray.direction.z) * 180 / M_PI;
  };
  EXPECT_NEAR(angle(lens.ray({80, 45}, {})), 0, 1e-4);
  EXPECT_NEAR(angle(lens.ray({80, 0}, {})), 20, 1e-4);
  EXPECT_NEAR(angle(lens.ray({160, 45}, {})), std::atan(std::tan(20 * M_PI / 180) * 16 / 9) * 180 / M_PI,
              1e-4);
  EXPECT_GT(lens.ray({80, 0}, {}).direction.y, 0);    // the first row is up
  EXPECT_GT(lens.ray({160, 45}, {}).direction.x, 0);  // the last column is to the right
}

TEST(Lens, ProjectsWhereRaysComeFrom) {
  Camera tilted = camera(0, 0);
  tilted.target = {-2, 1, 0.5};
  tilted.up = {0.2, 1, -0.1};
  const Lens lens(tilted, 160, 90);
  for (const Vec2 pixel : {Vec2{80, 45}, Vec2{0, 0}, Vec2{160, 90}, Vec2{12.5f, 71}}) {
    const Ray ray = lens.ray(pixel, {});
    for (const float distance : {0.5f, 30.0f}) {
      const Vec3 point = ray.origin + ray.direction * distance;
      const auto seen = lens.project({point.x, point.y, point.z});
      ASSERT_TRUE(seen);
      EXPECT_NEAR(seen->x, pixel.x, 1e-3f);
      EXPECT_NEAR(seen->y, pixel.y, 1e-3f);
    }
    const Vec3 behind = ray.origin + ray.direction * -1.0f;
    EXPECT_FALSE(lens.project({behind.x, behind.y, behind.z}));
  }
}

TEST(Lens, RaysMeetInTheFocalPlane) {
  const Lens lens(camera(0.2, 4), 160, 90);
  CounterRng rng(1);
  const Vec3 sharp = at_depth(Lens(camera(0, 4), 160, 90).ray({33, 70}, {}), 4);
  for (int i = 0; i < 200; ++i) {
    const Ray ray =
        lens.ray({33, 70}, {static_cast<float>(rng.uniform()), static_cast<float>(rng.uniform())});
    EXPECT_LT(length(at_depth(ray, 4) - sharp), 1e-5f);
    EXPECT_NEAR(length(ray.direction), 1, 1e-6f);
  }
}

// Circle of confusion: similar triangles give the radius r |d − f| / f at distance d.
TEST(Lens, CircleOfConfusion) {
  constexpr double kRadius = 0.2, kFocus = 4;
  const Lens lens(camera(kRadius, kFocus), 160, 90);
  CounterRng rng(2);
  for (const float d : {2.0f, 3.0f, 8.0f}) {
    const double wanted = kRadius * std::abs(d - kFocus) / kFocus;
    const Vec3 middle = at_depth(Lens(camera(0, kFocus), 160, 90).ray({100, 20}, {}), d);
    double largest = 0, squares = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vec3 p = at_depth(
          lens.ray({100, 20}, {static_cast<float>(rng.uniform()), static_cast<float>(rng.uniform())}), d);
      largest = std::max(largest, double(length(p - middle)));
      squares += length2(p - middle);
    }
    EXPECT_NEAR(largest, wanted, 0.01 * wanted);
    EXPECT_NEAR(std::sqrt(squares / 4000), wanted / std::sqrt(2.0), 0.02 * wanted);  // of an even disk
  }
}

TEST(Lens, FocusDefaultsToTheTarget) {
  const Lens lens(camera(0.2, 0), 160, 90);
  EXPECT_LT(length(at_depth(lens.ray({80, 45}, {0.9f, 0.3f}), 10) - Vec3(1, 2, -7)), 1e-5f);
}

TEST(Lens, RefusesToLookNowhere) {
  Camera c;
  c.target = c.position;
  EXPECT_THROW(Lens(c, 16, 9), Error);
  c.target = c.position + Eigen::Vector3d(0, 1, 0);
  EXPECT_THROW(Lens(c, 16, 9), Error);
}

}  // namespace
}  // namespace vivify::render
