// What parts look like that the scene gives no material: as their asset file says.
#include <gtest/gtest.h>

#include "common/file.h"
#include "render/film.h"
#include "render/image_io.h"
#include "tests/common/glb.h"
#include "tests/pipeline/program.h"
#include "tests/pipeline/tiny_scene.h"

namespace vivify::pipeline {
namespace {

using testing_support::ball_mesh;
using testing_support::glb_text;
using testing_support::Outcome;
using testing_support::TinyScene;
using testing_support::vivify;

const std::string kHalves =
    R"({"name":"left","pbrMetallicRoughness":{"baseColorFactor":[0.8,0.1,0.2,1],"metallicFactor":0,"roughnessFactor":0}},
       {"name":"right","pbrMetallicRoughness":{"baseColorFactor":[0.9,0.6,0.3,1],"metallicFactor":1}})";
const Eigen::Vector3f kLeft(0.8f, 0.1f, 0.2f), kRight(0.9f, 0.6f, 0.3f), kClay(0.7f, 0.4f, 0.3f);

// The ball of the tiny scene with a left and a right half (x < 0 and x > 0), and no looks.
TriangleMesh ball_of_halves() {
  TriangleMesh ball = ball_mesh(0.5, 2);
  ball.face_part.resize(ball.F.rows());
  for (Eigen::Index f = 0; f < ball.F.rows(); ++f) {
    ball.face_part[f] = ball.V(ball.F(f, 0), 0) + ball.V(ball.F(f, 1), 0) + ball.V(ball.F(f, 2), 0) > 0;
  }
  return ball;
}

// The first picture of the tiny scene: colours of the surfaces on the left and right of the middle.
struct Colors {
  Eigen::Vector3f left, right;
};
Colors colors(const TinyScene& scene) {
  const Outcome outcome = vivify(
      {"render", scene.file().string(), "-o", scene.out().string(), "--progress=none", "--frames", "1"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const render::Film film = render::decode_exr(read_file(scene.out() / "render/tiny.0001.exr"));
  const auto pixel = [&](int x) { return Eigen::Vector3f(film.albedo.data() + 3 * (9 * film.width + x)); };
  return {pixel(14), pixel(17)};
}

void expect_color(const Eigen::Vector3f& color, const Eigen::Vector3f& expected) {
  EXPECT_LT((color - expected).cwiseAbs().maxCoeff(), 1e-3) << color.transpose();
}

TEST(AssetLooks, AreThoseOfPartsThatTheSceneLeavesOut) {
  TinyScene scene;
  scene.write("ball.glb", glb_text(ball_of_halves(), kHalves));
  scene.change("mesh: ball.obj", "mesh: ball.glb");
  scene.change("looks: {all: clay}", "looks: {}");
  const Colors own = colors(scene);
  expect_color(own.left, kLeft);
  expect_color(own.right, kRight);
  scene.change("looks: {}", "looks: {left: clay}");
  const Colors one = colors(scene);
  expect_color(one.left, kClay);
  expect_color(one.right, kRight);
  scene.change("looks: {left: clay}", "looks: {all: clay}");
  const Colors all = colors(scene);
  expect_color(all.left, kClay);
  expect_color(all.right, kClay);
}

// A scene of the ball as a prop only.
class PropScene : public TinyScene {
 public:
  PropScene() {
    write("tiny.yaml",
          "version: 1\nframes: {duration_s: 0.1}\n"
          "props:\n  - {name: ball, mesh: ball.glb, position: [0, 0.5, 0]}\n"
          "camera: {position: [0, 1, 4], target: [0, 0.5, 0]}\n"
          "render: {size: [32, 18], spp: 1}\n");
  }
};

std::string one_pixel(std::uint8_t red, std::uint8_t green, std::uint8_t blue) {
  const Bytes png = render::encode_png(1, 1, std::vector<std::uint8_t>{red, green, blue});
  return {reinterpret_cast<const char*>(png.data()), png.size()};
}

TEST(AssetLooks, TexturesMultiplyTheColorAndAreDrawnAgainWhenTheyChange) {
  const PropScene scene;
  const std::string material =
      R"({"name":"b","pbrMetallicRoughness":{"baseColorFactor":[0.5,0.5,0.5,1],"metallicFactor":0,
      "baseColorTexture":{"index":0}}})";
  const std::string glb = glb_text(ball_mesh(0.5, 2), material, one_pixel(255, 0, 255));
  scene.write("ball.glb", glb);
  expect_color(colors(scene).left, {0.5f, 0, 0.5f});
  scene.write("ball.glb", glb_text(ball_mesh(0.5, 2), material, one_pixel(0, 255, 0)));
  expect_color(colors(scene).left, {0, 0.5f, 0});

  // The same with the image in a file beside the mesh.
  std::string beside = glb;
  const std::string inside = R"("bufferView":2)";
  const std::size_t at = beside.find(inside + "}],\"meshes\"");
  ASSERT_NE(at, beside.npos);
  scene.write("ball.glb", beside.replace(at, inside.size(), R"("uri":"i.png" )"));
  scene.write("i.png", one_pixel(255, 255, 0));
  expect_color(colors(scene).left, {0.5f, 0.5f, 0});
  scene.write("i.png", one_pixel(0, 0, 255));
  expect_color(colors(scene).left, {0, 0, 0.5f});
}

TEST(AssetLooks, PartsThatNothingIsSaidOfAreGrey) {
  const PropScene scene;
  scene.write("ball.glb", glb_text(ball_mesh(0.5, 2), R"({"name":"b"})"));
  const Eigen::Vector3f color = colors(scene).left;
  EXPECT_EQ(color.minCoeff(), color.maxCoeff());
  EXPECT_GT(color[0], 0);
}

TEST(AssetLooks, ImagesThatAreMissingAreToldByCheck) {
  const PropScene scene;
  std::string text = glb_text(ball_mesh(0.5, 2),
                              R"({"name":"b","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})", "x");
  text.replace(text.find(R"("bufferView":2})"), 14, R"("uri":"no.png")");
  scene.write("ball.glb", text);
  const Outcome outcome = vivify({"check", scene.file().string()});
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_NE(outcome.err.find("tiny.yaml:4:"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("no.png"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace vivify::pipeline
