// Bodies and colliders that contact cannot begin with, through the real program: the exit code, and a message
// with the place in the file, the names, how far it is off and what to do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "common/file.h"
#include "common/hdf5_file.h"
#include "tests/pipeline/program.h"
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
using testing_support::vivify;

// A square of 1 m with its middle at the origin, in x and y or x and z.
TriangleMesh square(int cells, int up) {
  TriangleMesh mesh;
  mesh.V = Points::Zero((cells + 1) * (cells + 1), 3);
  mesh.F.resize(2 * cells * cells, 3);
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i <= cells; ++i) {
      mesh.V(j * (cells + 1) + i, 0) = static_cast<double>(i) / cells - 0.5;
      mesh.V(j * (cells + 1) + i, up) = static_cast<double>(j) / cells - 0.5;
    }
  }
  for (int cell = 0; cell < cells * cells; ++cell) {
    const int corner = cell / cells * (cells + 1) + cell % cells;
    mesh.F.row(2 * cell) << corner, corner + cells + 1, corner + 1;
    mesh.F.row(2 * cell + 1) << corner + 1, corner + cells + 1, corner + cells + 2;
  }
  return mesh;
}

// Bodies begin at line 4 of the scene, each on its own; then come colliders.
class ContactScene {
 public:
  ContactScene(const std::vector<std::string>& bodies, const std::string& collider) {
    std::string scene = "version: 1\nframes: {fps: 24, duration_s: 0.25}\nbodies:\n";
    for (const std::string& body : bodies) scene += "  - {" + body + "}\n";
    scene += "colliders:\n  - {" + collider + "}\n";
    write_file_atomic(file(), std::string_view(scene));
    TriangleMesh holed = ball_mesh(1, 2), flipped = ball_mesh(1, 2);
    holed.F.conservativeResize(holed.F.rows() - 2, 3);
    std::swap(flipped.F(20, 0), flipped.F(20, 1));
    for (const auto& [name, mesh] :
         {std::pair{"box.obj", box_mesh({0.4, 0.5, 0.3})}, std::pair{"plate.obj", box_mesh({3, 0.1, 3})},
          std::pair{"cloth.obj", square(4, 2)}, std::pair{"card.obj", square(1, 1)},
          std::pair{"holed.obj", holed}, std::pair{"flipped.obj", flipped}})
      write_file_atomic(folder_ / name, std::string_view(obj_text(mesh)));
  }
  fs::path file() const { return folder_ / "scene.yaml"; }
  fs::path out() const { return folder_ / "out"; }
  Outcome simulate() const {
    return vivify({"simulate", file().string(), "-o", out().string(), "--progress=none", "-q"});
  }

 private:
  TemporaryFolder folder_;
};

std::string box(const std::string& name, const std::string& position) {
  return "name: " + name + ", mesh: box.obj, tetrahedra: {vertices: 30}, position: [" + position +
         "], rest_space: {type: full}";
}
std::string shell(const std::string& name, const std::string& position, const std::string& thickness) {
  return "name: " + name + ", mesh: " + name + ".obj, position: [" + position +
         "], rest_space: {type: full}, model: {type: shell3d, thickness: " + thickness + "}";
}
constexpr const char* kPlate = "name: plate, mesh: plate.obj, position: [0, -0.1, 0]";

struct Refused {
  const char* name;
  std::vector<std::string> bodies;
  std::string collider;
  int code;
  std::vector<std::string> says;
};
void PrintTo(const Refused& c, std::ostream* stream) { *stream << c.name; }

class RefusedTest : public testing::TestWithParam<Refused> {};

TEST_P(RefusedTest, IsReportedWithItsPlace) {
  const ContactScene scene(GetParam().bodies, GetParam().collider);
  const Outcome outcome = scene.simulate();
  EXPECT_EQ(outcome.code, GetParam().code) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  for (const std::string& part : GetParam().says) EXPECT_THAT(outcome.err, HasSubstr(part));
  EXPECT_FALSE(fs::exists(scene.out() / "sim/frames/0001.h5"));
}

INSTANTIATE_TEST_SUITE_P(
    Contact, RefusedTest,
    testing::Values(
        Refused{"inside_each_other",
                {box("one", "0, 0.5, 0"), box("two", "0.7, 0.55, 0.05")},
                kPlate,
                3,
                {"scene.yaml:5:70: error: bodies 'one' and 'two' start 0.1 m inside each other",
                 "contact resolves at most 0.02 m", "(move one of them away by that much)"}},
        // Their surfaces lie in each other: no corner of one is inside the other.
        Refused{"aligned",
                {box("one", "0, 0.5, 0"), box("two", "0.6, 0.5, 0")},
                kPlate,
                3,
                {"scene.yaml:5:70: error: bodies 'one' and 'two' start 0."}},
        Refused{"in_the_same_place",
                {box("one", "0, 0.5, 0"), box("two", "0, 0.5, 0")},
                kPlate,
                3,
                {"scene.yaml:5:70: error: bodies 'one' and 'two' start 0."}},
        Refused{"in_a_collider",
                {box("one", "0, 0.45, 0")},
                kPlate,
                3,
                {"scene.yaml:4:70: error: body 'one' starts 0.05 m inside collider 'plate'",
                 "contact resolves at most 0.02 m", "(move it out of the collider)"}},
        Refused{"thin_across_thin",
                {shell("cloth", "0, 1, 0", "0.001"), shell("card", "0.02, 1, 0.03", "0.001")},
                kPlate,
                3,
                {"scene.yaml:5:44: error: bodies 'cloth' and 'card' start across each other",
                 "(move one of them away)"}},
        Refused{"thin_across_solid",
                {shell("cloth", "0.05, 1.03, 0", "0.01"), box("one", "0, 1, 0")},
                kPlate,
                3,
                {"scene.yaml:5:70: error: bodies 'cloth' and 'one' start 0.", " m inside each other"}},
        Refused{"hole_in_a_collider",
                {box("one", "0, 5, 0")},
                "name: rock, mesh: holed.obj",
                3,
                {"scene.yaml:6:24: error: collider 'rock': a hole of 4 edges", "close them"}},
        Refused{"flipped_face_of_a_collider",
                {box("one", "0, 5, 0")},
                "name: rock, mesh: flipped.obj",
                3,
                {"scene.yaml:6:24: error: collider 'rock': the faces on both sides of 3 edges face opposite",
                 "flip faces"}},
        Refused{"collider_that_jumps",
                {box("one", "0, 5, 0")},
                "name: lift, mesh: plate.obj, motion: [{t_s: 0}, {t_s: 0.1, position: [0, 50, 0]}]",
                2,
                {"scene.yaml:6:54: error: colliders[0].motion[1] jumps: 50 m", "100 m/s at most"}},
        Refused{"collider_in_two_places",
                {box("one", "0, 5, 0")},
                "name: lift, mesh: plate.obj, motion: [{t_s: 1}, {t_s: 1, position: [0, 1, 0]}]",
                2,
                {"scene.yaml:6:54: error: colliders[0].motion[1].t_s = 1 s is not after", "cannot jump"}},
        Refused{"shell_without_thickness",
                {shell("cloth", "0, 1, 0", "0")},
                kPlate,
                2,
                {"scene.yaml:4:117: error: bodies[0].model.thickness = 0 m must be > 0"}},
        Refused{"shell_of_negative_thickness",
                {shell("cloth", "0, 1, 0", "-0.01")},
                kPlate,
                2,
                {"scene.yaml:4:117: error: bodies[0].model.thickness = -0.01 m must be > 0"}},
        Refused{"rod_without_thickness",
                {"name: rod, model: {type: rod2d, thickness: 0}, outline: {type: polyline, points: [[0, 1], "
                 "[0, 2]]}"},
                kPlate,
                2,
                {"scene.yaml:4:49: error: bodies[0].model.thickness = 0 m must be > 0"}},
        Refused{"rod_of_negative_thickness",
                {"name: rod, model: {type: rod2d, thickness: -1e-3}, outline: {type: polyline, points: [[0, "
                 "1], [0, 2]]}"},
                kPlate,
                2,
                {"scene.yaml:4:49: error: bodies[0].model.thickness = -0.001 m must be > 0"}}),
    [](const auto& parameter) { return std::string(parameter.param.name); });

// 1 % of the height of both bodies, and of one in the plate.
TEST(StartInside, ALittleIsPushedApart) {
  const ContactScene scene({box("one", "0, 0.49, 0"), box("two", "0.79, 0.55, 0.05")}, kPlate);
  const Outcome outcome = scene.simulate();
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  double fastest = 0;
  for (int frame = 1; frame <= 6; ++frame) {
    const Hdf5Reader state(scene.out() / ("sim/frames/000" + std::to_string(frame) + ".h5"));
    for (const char* body : {"one", "two"})
      fastest = std::max(fastest, state.matrix(std::string("/bodies/") + body + "/v").cwiseAbs().maxCoeff());
    if (frame < 6) continue;
    for (const char* contacts : {"/contacts/distance", "/bodies/one/contacts/distance"}) {
      if (state.has(contacts)) {
        EXPECT_GT(state.vector(contacts).minCoeff(), -0.002) << contacts;
      }
    }
  }
  EXPECT_LT(fastest, 3);
}

// Near, but with room: shells side by side, and a body that stands with its edge on a plate's.
TEST(StartInside, WhatIsOnlyNearIsLetThrough) {
  const ContactScene scene({shell("cloth", "0, 1.1, 0", "0.01"), shell("card", "0.2, 0.55, 0.03", "0.01"),
                            box("one", "3.2, 0.5, 3.1")},
                           kPlate);
  const Outcome outcome = scene.simulate();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
}

}  // namespace
}  // namespace vivify::pipeline
