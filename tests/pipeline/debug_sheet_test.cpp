// `vivify sheet --debug`, through the real program.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "common/hdf5_file.h"
#include "render/image_io.h"
#include "tests/pipeline/program.h"
#include "tests/pipeline/tiny_scene.h"

namespace vivify::pipeline {
namespace {

using testing::HasSubstr;
using testing_support::box_mesh;
using testing_support::obj_text;
using testing_support::Outcome;
using testing_support::TinyScene;
using testing_support::vivify;

constexpr int kWidth = 640, kHeight = 360, kGap = 6, kLabel = 30;
constexpr int kRow = kHeight + kLabel + kGap;

class DebugSheet : public testing::Test {
 protected:
  Outcome run(const std::string& command, const std::vector<std::string>& options = {}) const {
    std::vector<std::string> arguments = {command, scene_.file().string(), "-o", scene_.out().string(),
                                          "--progress=none"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return vivify(arguments);
  }
  // One picture of 640 by 360.
  Outcome sheet(const std::vector<std::string>& options) const {
    std::vector<std::string> arguments = {
        "sheet", scene_.out().string(), "--columns", "1", "--width", std::to_string(kWidth + 2 * kGap)};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return vivify(arguments);
  }
  render::Image picture() const { return render::read_image(scene_.out() / "sheet.png"); }

  TinyScene scene_;
};

// Whether a pixel has a colour of the overlay.
bool is_colour(const render::Image& image, Eigen::Vector2i at, const std::array<int, 3>& colour, int by = 8) {
  for (int c = 0; c < 3; ++c) {
    if (std::abs(255 * image.at(at.x(), at.y(), c) - colour[static_cast<std::size_t>(c)]) > by) return false;
  }
  return true;
}
int count(const render::Image& image, const std::array<int, 3>& colour) {
  int found = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) found += is_colour(image, {x + kGap, y + kGap}, colour);
  }
  return found;
}

constexpr std::array<int, 3> kSticks = {60, 220, 130}, kSlips = {255, 90, 30}, kForce = {255, 225, 60},
                             kGoal = {255, 110, 220}, kRestShape = {90, 200, 255}, kHeld = {185, 140, 255};

// A box slides on a plate: every contact is seen where a pinhole camera projects it, in the colour of slip,
// until it rests.
TEST_F(DebugSheet, ContactsAreDrawnWhereTheyAre) {
  scene_.write("ball.obj", obj_text(box_mesh({0.4, 0.4, 0.4})));
  scene_.change("position: [0, 0.5, 0]", "position: [0, 0.4, 0]\n    velocity: [1.5, 0, 0]");
  scene_.change("controller: {type: hop, heading_deg: 90}", "contact: {points: 24}");
  scene_.change("camera: {position: [0, 1, 4], target: [0, 0.5, 0], follow: ball}",
                "camera: {position: [1, -2, 3], target: [0.2, 0.1, -0.1], fov_deg: 40}");
  scene_.change("size: [32, 18]", "size: [640, 360]");
  ASSERT_EQ(run("simulate", {"--frames", "1-3"}).code, 0);
  const Outcome outcome = sheet({"--debug", "--count", "3"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const render::Image image = picture();

  const Hdf5Reader frame(scene_.out() / "sim/frames/0003.h5");
  const RowMatrixXd position = frame.matrix("/bodies/ball/contacts/position");
  const Eigen::VectorXd slip = frame.vector("/bodies/ball/contacts/slip");
  ASSERT_GE(position.rows(), 4);
  const Eigen::Vector3d eye(1, -2, 3), forward = (Eigen::Vector3d(0.2, 0.1, -0.1) - eye).normalized(),
                                       right = forward.cross(Eigen::Vector3d::UnitY()).normalized(),
                                       up = right.cross(forward);
  const double focal = kHeight / 2.0 / std::tan(20 * std::numbers::pi / 180);
  int slipping = 0;
  for (Eigen::Index i = 0; i < position.rows(); ++i) {
    const Eigen::Vector3d way = position.row(i).transpose() - eye;
    const double depth = way.dot(forward);
    const Eigen::Vector2i at(kGap + std::floor(kWidth / 2.0 + focal * way.dot(right) / depth),
                             kGap + 2 * kRow + std::floor(kHeight / 2.0 - focal * way.dot(up) / depth));
    slipping += slip[i] > 0;
    EXPECT_TRUE(is_colour(image, at, slip[i] > 0 ? kSlips : kSticks) || is_colour(image, at, kForce))
        << "contact " << i << " at " << at.transpose();
  }
  EXPECT_GE(slipping, 4);
}

TEST_F(DebugSheet, ShowsGoalsForcesAndRestShapesOverPictures) {
  scene_.change("size: [32, 18]", "size: [64, 36]");
  ASSERT_EQ(run("render", {"--frames", "5"}).code, 0);
  ASSERT_EQ(sheet({}).code, 0);
  const render::Image plain = picture();
  ASSERT_EQ(sheet({"--debug"}).code, 0);
  const render::Image debug = picture();
  EXPECT_EQ(plain.width, debug.width);
  EXPECT_LT(plain.height, debug.height);  // the legend
  for (const auto& colour : {kForce, kGoal, kRestShape}) {
    EXPECT_EQ(count(plain, colour), 0);
    EXPECT_GE(count(debug, colour), 40) << colour[0] << " " << colour[1] << " " << colour[2];
  }
  // The rest is the picture.
  EXPECT_TRUE(std::equal(plain.values.begin(), plain.values.begin() + 3 * plain.width * (kGap + 20),
                         debug.values.begin()));
}

// A cross in the middle of which every held vertex wants to be, until the handle lets go.
TEST_F(DebugSheet, HandlesAreDrawnWhereTheyWantTheBody) {
  scene_.write("ball.obj", obj_text(box_mesh({0.4, 0.4, 0.4})));
  scene_.change(
      "    mesh: ball.obj\n",
      "    mesh: ball.obj\n    handles: [{region: {min: [0, 0.9, 0], max: [1, 1, 1]}, until_s: 0.15, "
      "motion: [{t_s: 0}, {t_s: 0.1, move: [0.5, 0.2, 0]}]}]\n");
  scene_.change("controller: {type: hop, heading_deg: 90}", "controller: {type: rest}");
  scene_.change("camera: {position: [0, 1, 4], target: [0, 0.5, 0], follow: ball}",
                "camera: {position: [0, 0.5, 4], target: [0, 0.5, 0], fov_deg: 40}");
  scene_.change("size: [32, 18]", "size: [640, 360]");
  ASSERT_EQ(run("simulate", {"--frames", "1-5"}).code, 0);
  ASSERT_EQ(sheet({"--debug", "--count", "5"}).code, 0);
  const render::Image image = picture();
  const auto crosses = [&](int frame) {  // pixels of their colour
    int found = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x)
        found += is_colour(image, {kGap + x, kGap + (frame - 1) * kRow + y}, kHeld);
    }
    return found;
  };
  // Vertices at the end of the motion, projected along −z.
  const double focal = kHeight / 2.0 / std::tan(20 * std::numbers::pi / 180);
  const RowMatrixXd rest = Hdf5Reader(scene_.out() / "sim/frames/0001.h5").matrix("/bodies/ball/x");
  int held = 0;
  for (Eigen::Index i = 0; i < rest.rows(); ++i) {
    const Eigen::Vector3d place = rest.row(i).transpose() + Eigen::Vector3d(0.5, 0.2, 0);
    if (rest(i, 1) < 0.5 - 0.4 + 0.9 * 0.8) continue;
    ++held;
    const double scale = focal / (4 - place.z());
    const Eigen::Vector2i at(kGap + std::floor(kWidth / 2.0 + scale * place.x()),
                             kGap + 3 * kRow + std::floor(kHeight / 2.0 - scale * (place.y() - 0.5)));
    bool seen = false;  // the shade of a cross beside it may lie over its middle
    for (int y = -2; y <= 2; ++y) {
      for (int x = -2; x <= 2; ++x) seen |= is_colour(image, at + Eigen::Vector2i(x, y), kHeld, 40);
    }
    EXPECT_TRUE(seen) << "vertex " << i << " at " << at.transpose();
  }
  EXPECT_GE(held, 4);
  EXPECT_GE(crosses(4), 10);
  EXPECT_EQ(crosses(5), 0);
}

// Flat bodies touch with a closed line, which has no sides to outline: the drawn surface has.
TEST_F(DebugSheet, OutlinesFlatBodiesAsTheyAreDrawn) {
  scene_.change("mesh: ball.obj",
                "outline: {type: polygon, points: [[-0.4, 0], [0.4, 0], [0.4, 0.6], [-0.4, 0.6]]}");
  scene_.change("tetrahedra: {backend: tetgen, vertices: 60}", "triangles: {vertices: 30}");
  scene_.change("type: solid3d", "type: solid2d");
  ASSERT_EQ(run("simulate", {"--frames", "1-3"}).code, 0);
  const Outcome outcome = sheet({"--debug", "--count", "1"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  // Blue pixels go once around the rectangle, 0.8 by 0.6 m.
  const render::Image image = picture();
  Eigen::AlignedBox2i box;
  for (int y = kGap; y < kGap + kHeight; ++y) {
    for (int x = kGap; x < kGap + kWidth; ++x) {
      if (is_colour(image, {x, y}, kRestShape)) box.extend(Eigen::Vector2i(x, y));
    }
  }
  ASSERT_FALSE(box.isEmpty());
  const double width = box.sizes().x(), height = box.sizes().y();
  EXPECT_NEAR(width / height, 0.8 / 0.6, 0.1);
  EXPECT_GE(count(image, kRestShape), 0.6 * 2 * (width + height));
  EXPECT_LE(count(image, kRestShape), 1.5 * 2 * (width + height));
}

TEST_F(DebugSheet, NeedsARunThatWasSimulated) {
  ASSERT_EQ(run("mesh").code, 0);
  const Outcome outcome = sheet({"--debug"});
  EXPECT_EQ(outcome.code, 5);
  EXPECT_THAT(outcome.err, HasSubstr("vivify simulate"));
  const Outcome elsewhere = vivify({"sheet", scene_.folder().string(), "--debug"});
  EXPECT_EQ(elsewhere.code, 5);
  EXPECT_THAT(elsewhere.err, HasSubstr("scene.resolved.yaml"));
}

}  // namespace
}  // namespace vivify::pipeline
