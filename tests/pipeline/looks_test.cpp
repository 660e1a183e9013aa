#include "pipeline/looks.h"

#include <gtest/gtest.h>

#include "common/error.h"
#include "tests/common/glb.h"
#include "tests/pipeline/tiny_scene.h"

namespace vivify::pipeline {
namespace {

using testing_support::ball_mesh;
using testing_support::glb_text;
using testing_support::TinyScene;

constexpr const char* kMaterial = R"({"name":"skin","pbrMetallicRoughness":{
  "baseColorFactor":[0.9,0.6,0.3,1],"metallicFactor":METALLIC,"roughnessFactor":ROUGHNESS}})";

// The tiny scene with a body whose only part, `skin`, has this metallic and roughness factor.
Scene scene_with(TinyScene& tiny, const std::string& metallic, const std::string& roughness) {
  std::string material = kMaterial;
  material.replace(material.find("METALLIC"), 8, metallic);
  material.replace(material.find("ROUGHNESS"), 9, roughness);
  tiny.write("ball.glb", glb_text(ball_mesh(0.5, 1), material));
  std::vector<Error> errors;
  std::optional<Scene> scene = load_scene(tiny.file(), {"bodies.ball.mesh=ball.glb"}, errors);
  EXPECT_TRUE(scene) << (errors.empty() ? "" : errors.front().full_text());
  return std::move(scene).value();
}

const Value& skin_of(const Scene& scene, const render::Looks& looks) {
  return looks.materials.at(part_materials(scene.settings["bodies"].items()[0], {"skin"}, looks).at(0));
}

TEST(SceneLooks, PartsOfMetalAreMetalAndOthersHaveAGlaze) {
  TinyScene tiny;
  tiny.change("looks: {all: clay}", "looks: {}");
  struct Case {
    const char *metallic, *roughness, *type;
    double expected;
  };
  for (const auto& [metallic, roughness, type, expected] :
       {Case{"1", "0.25", "metal", 0.25}, Case{"0.5", "1", "metal", 1}, Case{"0.49", "0.4", "porcelain", 0.4},
        Case{"0", "0", "porcelain", 0.05}}) {  // no material is smoother than 0.05
    const Scene scene = scene_with(tiny, metallic, roughness);
    const render::Looks looks = scene_looks(scene);
    const Value& skin = skin_of(scene, looks);
    EXPECT_EQ(skin["type"].as_string(), type) << metallic;
    EXPECT_EQ(skin["roughness"].as_number(), expected);
    EXPECT_EQ(skin["color"].as_vector3(), Eigen::Vector3d(0.9, 0.6, 0.3));
  }
}

TEST(SceneLooks, FilesThatNoPartNeedsAreNotRead) {
  TinyScene tiny;
  const Scene scene = scene_with(tiny, "\"no number\"", "0");
  EXPECT_EQ(skin_of(scene, scene_looks(scene))["color"].as_vector3(), Eigen::Vector3d(0.7, 0.4, 0.3));
}

TEST(SceneLooks, WrongPartsAreTold) {
  TinyScene tiny;
  tiny.change("looks: {all: clay}", "looks: {skn: clay}");
  const Scene scene = scene_with(tiny, "0", "0.5");
  try {
    check_looks(scene.settings["bodies"].items()[0], {"skin"});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_EQ(error.hint(), "did you mean 'skin'?");
    EXPECT_EQ(error.where().line, 13);
  }
}

}  // namespace
}  // namespace vivify::pipeline
