#include "render/scene.h"

#include <gtest/gtest.h>

#include "common/error.h"
#include "tests/render/render_support.h"

namespace vivify::render {
namespace {

using testing_support::settings;

TEST(Scene, PreviewIsTheDefault) {
  const RenderSettings s = make_settings(settings(render_schema(), "{}"));
  EXPECT_EQ(s.width, 480);
  EXPECT_EQ(s.height, 270);
  EXPECT_EQ(s.spp, 8);
  EXPECT_EQ(s.clamp, 0);  // unbiased
}

TEST(Scene, QualitiesAreOverrides) {
  const auto with_quality = [](const std::string& name) {
    std::vector<Error> errors;
    ConfigNode root = parse_yaml("render: {size: [10, 10], spp: 1}", "test", errors);
    for (const std::string& assignment : quality_overrides(name)) apply_override(root, assignment);
    const Value value = resolve(object("Scene.").field("render", render_schema()), root, errors);
    EXPECT_TRUE(errors.empty());
    return make_settings(value["render"]);
  };
  EXPECT_EQ(with_quality("draft").height, 180);
  EXPECT_EQ(with_quality("draft").spp, 4);
  EXPECT_EQ(with_quality("final").width, 1280);
  EXPECT_EQ(with_quality("final").spp, 64);
  const RenderSettings preview = with_quality("preview"),
                       standard = make_settings(settings(render_schema(), "{}"));
  EXPECT_EQ(preview.splits, standard.splits);
  EXPECT_EQ(preview.spp, standard.spp);
  EXPECT_THROW(quality_overrides("best"), Error);
}

TEST(Scene, SizeIsWholePixels) {
  EXPECT_THROW(make_settings(settings(render_schema(), "{size: [10.5, 10]}")), Error);
}

TEST(Scene, CameraIsRead) {
  const Camera camera = make_camera(
      settings(camera_schema(),
               "{position: [1, 2, 3], target: [0, 1, 0], fov_deg: 50, aperture_radius_m: 0.02, focus_m: 2}"));
  EXPECT_EQ(camera.position, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(camera.target, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(camera.fov_deg, 50);
  EXPECT_EQ(camera.aperture_radius_m, 0.02);
  EXPECT_EQ(camera.focus_m, 2);
}

}  // namespace
}  // namespace vivify::render
