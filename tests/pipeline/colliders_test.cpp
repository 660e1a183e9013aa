// Colliders from the scene file to the simulation and the picture: meshes, shapes, motion, and what is wrong
// with them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/file.h"
#include "common/hdf5_file.h"
#include "common/text.h"
#include "render/film.h"
#include "tests/pipeline/program.h"
#include "tests/pipeline/simulated_run.h"
#include "tests/pipeline/tiny_scene.h"

namespace vivify::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::ball_mesh;
using testing_support::box_mesh;
using testing_support::obj_text;
using testing_support::Outcome;
using testing_support::TemporaryFolder;
using testing_support::TinyScene;
using testing_support::vivify;

// A scene of colliders only; they begin at line 5, each on its own.
class ColliderScene {
 public:
  explicit ColliderScene(const std::vector<std::string>& colliders) {
    std::string scene =
        "version: 1\nframes: {fps: 4, duration_s: 1}\nrender: {size: [96, 54], spp: 1}\ncolliders:\n";
    for (const std::string& collider : colliders) scene += "  - {" + collider + "}\n";
    scene += "camera: {position: [0, 0, 6], target: [0, 0, 0], fov_deg: 40}\n";
    write_file_atomic(file(), std::string_view(scene));
    write("box.obj", box_mesh({0.6, 0.2, 0.2}));
  }

  fs::path file() const { return folder_ / "scene.yaml"; }
  void write(const std::string& name, const TriangleMesh& mesh) const {
    write_file_atomic(folder_ / name, std::string_view(obj_text(mesh)));
  }
  Outcome check() const { return vivify({"check", file().string()}); }
  render::Film picture(int frame) const {
    const Outcome outcome = vivify({"render", file().string(), "-o", (folder_ / "out").string(),
                                    "--progress=none", "--frames", std::to_string(frame)});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return render::decode_exr(read_file(folder_ / ("out/render/scene.000" + std::to_string(frame) + ".exr")));
  }

 private:
  TemporaryFolder folder_;
};

struct WrongCollider {
  const char* name;
  std::vector<std::string> colliders;
  std::vector<std::string> says;
  int code = 2;
};

void PrintTo(const WrongCollider& c, std::ostream* stream) { *stream << c.name; }

class WrongColliderTest : public testing::TestWithParam<WrongCollider> {};

TEST_P(WrongColliderTest, IsReportedWithItsPlace) {
  const ColliderScene scene(GetParam().colliders);
  TriangleMesh holed = ball_mesh(1, 2), flipped = ball_mesh(1, 2), inward = ball_mesh(1, 2);
  holed.F.conservativeResize(holed.F.rows() - 2, 3);
  std::swap(flipped.F(20, 0), flipped.F(20, 1));
  inward.F.col(0).swap(inward.F.col(1));
  scene.write("holed.obj", holed);
  scene.write("flipped.obj", flipped);
  scene.write("inward.obj", inward);
  const Outcome outcome = scene.check();
  EXPECT_EQ(outcome.code, GetParam().code) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  for (const std::string& part : GetParam().says) EXPECT_THAT(outcome.err, HasSubstr(part));
}

INSTANTIATE_TEST_SUITE_P(
    Colliders, WrongColliderTest,
    testing::Values(
        WrongCollider{
            "neither", {"name: a"}, {"scene.yaml:5:5:", "colliders[0] needs either `mesh` or `shape`"}},
        WrongCollider{"both",
                      {"name: a, mesh: box.obj, shape: {type: plane}"},
                      {"scene.yaml:5:37:", "colliders[0] needs either `mesh` or `shape`"}},
        WrongCollider{"shape_without_radius",
                      {"name: a, shape: {type: sphere}"},
                      {":5:", "colliders[0].shape.radius is missing"}},
        WrongCollider{"unknown_shape",
                      {"name: a, shape: {type: spere}"},
                      {":5:", "colliders[0].shape.type = spere", "did you mean sphere?"}},
        WrongCollider{"plane_without_direction",
                      {"name: a, mesh: box.obj", "name: b, shape: {type: plane, normal: [0, 0, 0]}"},
                      {"scene.yaml:6:44:", "the normal of a plane has no length"}},
        WrongCollider{"ragged_heights",
                      {"name: a, shape: {type: height_field, heights: [[0, 1], [0, 1, 2]]}"},
                      {"scene.yaml:5:61:", "row 1 of a height field has 3 heights and the first row 2"}},
        WrongCollider{"keys_at_the_same_time",
                      {"name: a, mesh: box.obj, motion: [{t_s: 0}, {t_s: 1}, {t_s: 1, position: [1, 0, 0]}]"},
                      {"scene.yaml:5:59:", "colliders[0].motion[2].t_s = 1 s is not after the key before it",
                       "cannot jump"}},
        WrongCollider{"keys_in_disorder",
                      {"name: a, mesh: box.obj, motion: [{t_s: 1}, {t_s: 0.5}]"},
                      {"scene.yaml:5:49:", "motion[1].t_s = 0.5 s is not after", "in the order of time"}},
        WrongCollider{"keys_too_far_apart",
                      {"name: a, mesh: box.obj, motion: [{t_s: 0}, {t_s: 0.1, position: [0, 50, 0]}]"},
                      {"scene.yaml:5:49:", "motion[1] jumps: 50 m from the key before it, 0.1 s earlier",
                       "100 m/s at most"}},
        WrongCollider{
            "repeated_jump",
            {"name: a, mesh: box.obj, repeat_motion: true, motion: [{t_s: 0}, {t_s: 1, position: [1, 0, "
             "0]}]"},
            {"scene.yaml:5:70:", "motion[1] jumps back to the first key"}},
        WrongCollider{"repeated_rest",
                      {"name: a, mesh: box.obj, repeat_motion: true"},
                      {"scene.yaml:5:45:", "colliders[0].repeat_motion does not fit: there is no motion"}},
        WrongCollider{"hole",
                      {"name: a, mesh: box.obj", "name: rock, mesh: holed.obj"},
                      {"scene.yaml:6:24: error: collider 'rock': a hole of 4 edges", "from ("},
                      3},
        WrongCollider{
            "flipped_face",
            {"name: rock, mesh: flipped.obj"},
            {"scene.yaml:5:24: error: collider 'rock': the faces on both sides of 3 edges face opposite "
             "ways"},
            3},
        WrongCollider{"inward",
                      {"name: rock, mesh: inward.obj"},
                      {"scene.yaml:5:24: error: collider 'rock': its surface is closed and faces inward"},
                      3}),
    [](const auto& parameter) { return parameter.param.name; });

TEST(Colliders, WrongOnesStopARunBeforeItBegins) {
  TinyScene scene;
  TriangleMesh plate = box_mesh({3, 0.1, 3});
  std::swap(plate.F(0, 0), plate.F(0, 1));
  scene.write("plate.obj", obj_text(plate));
  const Outcome outcome =
      vivify({"run", scene.file().string(), "-o", scene.out().string(), "--progress=none"});
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("collider 'plate'"));
  EXPECT_FALSE(fs::exists(scene.out() / "mesh/ball.h5"));
}

// A plane and a plate of the same height are the same to what stands on them.
TEST(Colliders, ShapesCarryBodiesLikeMeshes) {
  TinyScene scene;
  const auto simulate = [&](const std::string& out) {
    const Outcome outcome =
        vivify({"simulate", scene.file().string(), "-o", scene.out(out).string(), "--progress=none"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return Hdf5Reader(scene.out(out) / "sim/frames/0006.h5").matrix("/bodies/ball/x");
  };
  const RowMatrixXd on_plate = simulate("plate");
  scene.change("mesh: plate.obj, position: [0, -0.1, 0]", "shape: {type: plane}");
  const RowMatrixXd on_plane = simulate("plane");
  EXPECT_LE((on_plate - on_plane).cwiseAbs().maxCoeff(), 1e-7);
  const testing_support::Steps steps(scene.out("plane") / "sim/steps.csv");
  EXPECT_GT(steps.largest("contacts"), 0);
}

TEST(Colliders, EverySettingOfThePhysicsIsSimulatedAgain) {
  TinyScene scene;
  const auto missing = [&] {
    const Outcome outcome =
        vivify({"simulate", scene.file().string(), "-o", scene.out().string(), "--dry-run"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.out.find("simulate: nothing to do") == outcome.out.npos;
  };
  scene.change("mesh: plate.obj, position: [0, -0.1, 0]", "shape: {type: plane, normal: [0, 1, 0]}");
  ASSERT_EQ(vivify({"simulate", scene.file().string(), "-o", scene.out().string(), "--progress=none"}).code,
            0);
  EXPECT_FALSE(missing());
  const std::string before = read_text_file(scene.file());
  for (const char* setting :
       {"friction: 0.5", "surface_velocity: [0.1, 0, 0]", "motion: [{t_s: 1, position: [0, -0.1, 0]}]"}) {
    scene.change("{type: plane, normal: [0, 1, 0]}",
                 std::string("{type: plane, normal: [0, 1, 0]}, ") + setting);
    EXPECT_TRUE(missing()) << setting;
    write_file_atomic(scene.file(), std::string_view(before));
    EXPECT_FALSE(missing());
  }
  scene.change("normal: [0, 1, 0]", "normal: [0.1, 1, 0]");
  EXPECT_TRUE(missing());
}

// Where an object is seen: the mean and the extent of its pixels.
struct Seen {
  int count = 0;
  double x = 0, y = 0;
  int left = 1000, right = -1, top = 1000, bottom = -1;
};
Seen seen(const render::Film& film, int id) {
  Seen seen;
  for (int y = 0; y < film.height; ++y) {
    for (int x = 0; x < film.width; ++x) {
      if (film.id[static_cast<std::size_t>(y * film.width + x)] != static_cast<float>(id)) continue;
      ++seen.count;
      seen.x += x + 0.5;
      seen.y += y + 0.5;
      seen.left = std::min(seen.left, x);
      seen.right = std::max(seen.right, x);
      seen.top = std::min(seen.top, y);
      seen.bottom = std::max(seen.bottom, y);
    }
  }
  seen.x /= seen.count;
  seen.y /= seen.count;
  return seen;
}

constexpr const char* kWall = "name: wall, shape: {type: plane, normal: [0, 0, 1]}, position: [0, 0, -1]";
constexpr const char* kBall = "name: ball, shape: {type: sphere, radius: 0.4}, ";

TEST(MovingColliders, AreDrawnWhereTheyAre) {
  const ColliderScene scene(
      {kWall, std::string(kBall) +
                  "motion: [{t_s: 0, position: [-1, -0.5, 0]}, {t_s: 0.75, position: [1, 0.7, 0]}]"});
  const double pixels_per_metre = 27 / (6 * std::tan(20 * std::numbers::pi / 180));
  const render::Film first = scene.picture(1), last = scene.picture(4);
  const Seen begin = seen(first, 2), end = seen(last, 2);
  EXPECT_NEAR(begin.x, 48 - pixels_per_metre, 0.7);
  EXPECT_NEAR(begin.y, 27 + 0.5 * pixels_per_metre, 0.7);
  EXPECT_NEAR(end.x, 48 + pixels_per_metre, 0.7);
  EXPECT_NEAR(end.y, 27 - 0.7 * pixels_per_metre, 0.7);
  EXPECT_NEAR(begin.count, std::numbers::pi * std::pow(0.4 * pixels_per_metre, 2), 12);
  // All else stays: the wall fills the rest of both pictures.
  for (std::size_t i = 0; i < first.pixels(); ++i) {
    EXPECT_TRUE(first.id[i] == 1 || first.id[i] == 2) << i;
    EXPECT_TRUE(last.id[i] == 1 || last.id[i] == 2) << i;
  }
}

// A picture of a moving object is that of the same object standing where it is at that time.
TEST(MovingColliders, LookLikeStandingOnes) {
  const ColliderScene moving(
      {kWall, std::string(kBall) +
                  "motion: [{t_s: 0.25, position: [0.5, 0.25, 0]}, {t_s: 1, position: [0, 1, "
                  "0]}]"});
  const ColliderScene standing({kWall, std::string(kBall) + "position: [0.5, 0.25, 0]"});
  const render::Film a = moving.picture(2), b = standing.picture(2);
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.rgba, b.rgba);
  EXPECT_NE(moving.picture(4).id, b.id);
}

TEST(MovingColliders, TurnAboutTheirOwnOrigin) {
  const ColliderScene scene(
      {"name: box, mesh: box.obj, position: [1, 0, 0], motion: [{t_s: 0}, {t_s: 0.75, "
       "rotation_deg: [0, 0, 90]}]"});
  const Seen flat = seen(scene.picture(1), 1), upright = seen(scene.picture(4), 1);
  EXPECT_NEAR(flat.x, upright.x, 0.7);
  EXPECT_NEAR(flat.y, upright.y, 0.7);
  EXPECT_NEAR(flat.right - flat.left, upright.bottom - upright.top, 1);
  EXPECT_NEAR(flat.bottom - flat.top, upright.right - upright.left, 1);
  EXPECT_GT(flat.right - flat.left, 2 * (flat.bottom - flat.top));
}

TEST(Shapes, AreAllDrawn) {
  const ColliderScene scene(
      {"name: rod, shape: {type: capsule, from: [-1, 1, 0], to: [1, 1, 0], radius: 0.2}",
       "name: ground, shape: {type: height_field, heights: [[0, 1, 0], [0, 0.5, 0], [0, 0, 0]]}, position: "
       "[0, -1, "
       "0]",
       kWall});
  const render::Film film = scene.picture(1);
  const Seen rod = seen(film, 1);
  const double pixels_per_metre = 27 / (6 * std::tan(20 * std::numbers::pi / 180));
  // A pixel at each side may be half covered.
  EXPECT_NEAR(rod.right - rod.left + 1, 2.4 * pixels_per_metre, 2.5);
  EXPECT_NEAR(rod.bottom - rod.top + 1, 0.4 * pixels_per_metre, 2.5);
  EXPECT_GT(seen(film, 2).count, 50);
  EXPECT_GT(seen(film, 3).count, 1000);
}

}  // namespace
}  // namespace vivify::pipeline
