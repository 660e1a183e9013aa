// Bodies of every model with rest spaces that suit them, from the scene file to the pictures; and settings
// that do not fit together.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/file.h"
#include "common/hdf5_file.h"
#include "common/mesh_io.h"
#include "common/text.h"
#include "tests/pipeline/program.h"
#include "tests/pipeline/tiny_scene.h"

namespace vivify::pipeline {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing_support::box_mesh;
using testing_support::files_below;
using testing_support::obj_text;
using testing_support::Outcome;
using testing_support::TemporaryFolder;
using testing_support::vivify;

// A sheet of 4 by 4 squares, 1 m wide, at height 0.3 m; bent upward at its middle by `bend` metres.
std::string sheet_text(double bend) {
  TriangleMesh mesh;
  mesh.V.resize(25, 3);
  for (int j = 0; j < 5; ++j) {
    for (int i = 0; i < 5; ++i) {
      const double x = 0.25 * i - 0.5, z = 0.25 * j - 0.5;
      mesh.V.row(5 * j + i) << x, 0.3 + bend * (1 - 4 * x * x), z;
    }
  }
  mesh.F.resize(32, 3);
  for (int j = 0, f = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i, f += 2) {
      const int a = 5 * j + i, b = a + 1, c = a + 5, d = c + 1;
      mesh.F.row(f) << a, c, d;
      mesh.F.row(f + 1) << a, d, b;
    }
  }
  return obj_text(mesh);
}

constexpr const char* kScene = R"(version: 1
frames: {fps: 24, duration_s: 0.167, steps_per_frame: 2}
bodies:
  - name: body
    BODY
colliders:
  - {name: plate, mesh: plate.obj, position: [0, -0.1, 0]}
camera: {position: [0, 1, 4], target: [0, 0.5, 0], follow: body}
render: {size: [32, 18], spp: 1}
)";
constexpr const char* kLean = R"(version: 1
handles:
  - {region: {min: [0, 0, 0], max: [1, 0.2, 1]}, pin: true}
  - {region: {min: [0, 0.8, 0], max: [1, 1, 1]}, move: [0.2, 0, 0]}
)";
constexpr const char* kLetter =
    "outline: {type: polygon, points: [[-0.3, 0], [0.3, 0], [0.1, 0.4], [0.3, 1], [-0.3, 1], [-0.1, 0.4]]}";
constexpr const char* kRing =
    "outline: {type: polygon, points: [[0.4, 0], [0.8, 0.4], [0.4, 0.8], [-0.4, 0.8], [-0.8, 0.4], [-0.4, "
    "0]]}";
constexpr const char* kLine = "outline: {type: polyline, points: [[0, 0.05], [0.2, 0.5], [0, 1]]}";

// A scene with one body, its lines given as a list.
class BodyScene {
 public:
  explicit BodyScene(const std::vector<std::string>& lines) {
    std::string body = join(lines);
    std::string scene = kScene;
    write_file_atomic(file(), scene.replace(scene.find("BODY"), 4, body));
    write("plate.obj", obj_text(box_mesh({3, 0.1, 3})));
    write("box.obj", obj_text(box_mesh({0.4, 0.5, 0.3})));
    write("sheet.obj", sheet_text(0));
    write("bent.obj", sheet_text(0.2));
    write("lean.yaml", kLean);
  }

  fs::path file() const { return folder_ / "scene.yaml"; }
  fs::path out(const std::string& name = "out") const { return folder_ / name; }
  void write(const std::string& name, const std::string& text) const {
    write_file_atomic(folder_ / name, std::string_view(text));
  }
  Outcome run(const std::string& command, const fs::path& to, std::vector<std::string> options = {}) const {
    std::vector<std::string> arguments = {command, file().string(), "-o", to.string(), "--progress=none"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return vivify(arguments);
  }
  json summary(const fs::path& to) const {
    return json::parse(read_text_file(to / "sim/summary.json")).at("bodies").at("body");
  }

 private:
  static std::string join(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += (text.empty() ? "" : "\n    ") + line;
    return text;
  }
  TemporaryFolder folder_;
};

struct Case {
  const char* name;
  const char* model;
  const char* space;
  std::vector<std::string> lines;
  int dimension;
  int params;  // -1: one for each degree of freedom
};

void PrintTo(const Case& c, std::ostream* stream) { *stream << c.name; }

class BodyTest : public testing::TestWithParam<Case> {};

TEST_P(BodyTest, RunsAndGoesOnWithTheSameBytes) {
  const Case& c = GetParam();
  const BodyScene scene(c.lines);
  const Outcome outcome = scene.run("simulate", scene.out());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const json body = scene.summary(scene.out());
  EXPECT_EQ(body.at("model"), c.model);
  EXPECT_EQ(body.at("space"), c.space);
  EXPECT_LE(body.at("max_residual_rel"), 1e-8);
  EXPECT_EQ(read_text_file(scene.out() / "sim/steps.csv").find("nan"), std::string::npos);
  const RowMatrixXd X0 = Hdf5Reader(scene.out() / "mesh/body.h5").matrix("/X0");
  EXPECT_EQ(X0.cols(), c.dimension);
  EXPECT_EQ(body.at("dofs"), X0.size());
  EXPECT_EQ(body.at("params"), c.params < 0 ? X0.size() : c.params);

  ASSERT_EQ(scene.run("simulate", scene.out("parts"), {"--frames", "1-2"}).code, 0);
  ASSERT_EQ(scene.run("simulate", scene.out("parts")).code, 0);
  for (const char* folder : {"mesh", "weights", "sim"}) {
    EXPECT_EQ(files_below(scene.out() / folder), files_below(scene.out("parts") / folder)) << folder;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Models, BodyTest,
    testing::Values(
        Case{"solid3d_full",
             "solid3d",
             "full",
             {"mesh: box.obj", "position: [0, 0.5, 0]", "tetrahedra: {vertices: 30}",
              "rest_space: {type: full}"},
             3,
             -1},
        Case{"solid3d_stvk_cage",
             "solid3d_stvk",
             "cage",
             {"mesh: box.obj", "position: [0, 0.5, 0]", "tetrahedra: {vertices: 30}",
              "model: {type: solid3d_stvk}", "rest_space: {type: cage, harmonic_unknowns: 500}",
              "controller: {type: hop}"},
             3,
             24},
        Case{"solid3d_pose",
             "solid3d",
             "examples",
             {"mesh: box.obj", "position: [0, 0.5, 0]", "tetrahedra: {vertices: 30}",
              "rest_space: {type: examples, examples: [{pose: lean.yaml}]}"},
             3,
             1},
        Case{"shell3d_full",
             "shell3d",
             "full",
             {"mesh: sheet.obj", "model: {type: shell3d}", "rest_space: {type: full}"},
             3,
             -1},
        Case{"shell3d_examples",
             "shell3d",
             "examples",
             {"mesh: sheet.obj", "scale: 0.5", "model: {type: shell3d}",
              "rest_space: {type: examples, examples: [{file: bent.obj}]}"},
             3,
             1},
        Case{"shell3d_cage",
             "shell3d",
             "cage",
             {"mesh: bent.obj", "model: {type: shell3d}", "triangles: {vertices: 40}",
              "rest_space: {type: cage, harmonic_unknowns: 500}"},
             3,
             24},
        Case{"solid2d_cage",
             "solid2d",
             "cage",
             {kLetter, "triangles: {vertices: 30}", "model: {type: solid2d}",
              "rest_space: {type: cage, vertices: 6, harmonic_unknowns: 500}",
              "controller: {type: hop, heading_deg: -90}"},
             2,
             12},
        Case{"solid2d_full",
             "solid2d",
             "full",
             {kLetter, "triangles: {vertices: 30}", "model: {type: solid2d}", "rest_space: {type: full}",
              "controller: {type: hop, heading_deg: -90}"},
             2,
             -1},
        Case{"solid2d_pose",
             "solid2d",
             "examples",
             {kLetter, "triangles: {vertices: 30}", "model: {type: solid2d}",
              "rest_space: {type: examples, examples: [{pose: lean.yaml, name: lean}]}",
              "controller: {type: hop, heading_deg: -90}"},
             2,
             1},
        Case{"solid2d_strains",
             "solid2d",
             "strains",
             {kLetter, "triangles: {vertices: 30}", "model: {type: solid2d}",
              "rest_space: {type: strains, examples: [{pose: lean.yaml}]}"},
             2,
             1},
        Case{
            "solid2d_printed_given_cage",
            "solid2d_printed",
            "cage",
            {kLetter, "position: [1, 0.1, 0]", "scale: 0.5", "triangles: {vertices: 30}",
             "model: {type: solid2d_printed}",
             "rest_space: {type: cage, points: [[-0.5, -0.1], [0.5, -0.1], [0, 6]], harmonic_unknowns: 500}"},
            2,
            6},
        Case{"rod2d_closed_cage",
             "rod2d",
             "cage",
             {kRing, "edges: {vertices: 24}", "model: {type: rod2d}",
              "rest_space: {type: cage, vertices: 6, harmonic_unknowns: 500}"},
             2,
             12},
        Case{"rod2d_open_full",
             "rod2d",
             "full",
             {kLine, "edges: {vertices: 12}", "model: {type: rod2d}", "rest_space: {type: full}"},
             2,
             -1},
        Case{"rod2d_open_pose",
             "rod2d",
             "examples",
             {kLine, "edges: {vertices: 12}", "model: {type: rod2d}",
              "rest_space: {type: examples, examples: [{pose: lean.yaml}]}"},
             2,
             1}),
    [](const auto& parameter) { return parameter.param.name; });

// A polygon of 60 corners on a circle of radius 0.4 m about (x, 0.5).
std::string circle(double x) {
  std::string points;
  for (int i = 0; i < 60; ++i) {
    const double angle = 2 * M_PI * i / 60;
    points += (i > 0 ? ", [" : "[") + number_text(x + 0.4 * std::cos(angle)) + ", " +
              number_text(0.5 + 0.4 * std::sin(angle)) + "]";
  }
  return "outline: {type: polygon, points: [" + points + "]}";
}

// Flat bodies touch one another with the outlines that are drawn, not with the few corners of their meshes.
TEST(FlatBodies, TouchWithTheirDrawnOutlines) {
  const std::string about =
      "triangles: {vertices: 20}\n    model: {type: solid2d, stiffness: 100000}\n    velocity: ";
  const BodyScene scene(
      {circle(-0.45), about + "[3, 0, 0]\n  - name: other", circle(0.45), about + "[-3, 0, 0]"});
  const Outcome outcome = scene.run("simulate", scene.out());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Hdf5Reader mesh(scene.out() / "mesh/body.h5");
  EXPECT_LT(mesh.matrix("/X0").rows(), 40);
  const RowMatrixXd V = mesh.matrix("/contact/V");
  const RowMatrixXi edges = mesh.int_matrix("/contact/F");
  ASSERT_GE(V.rows(), 60);
  double area = 0;
  for (Eigen::Index e = 0; e < edges.rows(); ++e) {
    const Eigen::RowVector2d a = V.row(edges(e, 0)), b = V.row(edges(e, 1));
    area += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  EXPECT_NEAR(area, 0.5 * 60 * 0.16 * std::sin(2 * M_PI / 60), 5e-4) << "counter-clockwise";
  // They have met, 0.1 m apart at first.
  bool met = false;
  for (const std::string frame : {"0002", "0003", "0004"})
    met |= Hdf5Reader(scene.out() / ("sim/frames/" + frame + ".h5")).has("/touching");
  EXPECT_TRUE(met);
}

class DrawnBodyTest : public testing::TestWithParam<std::pair<const char*, std::vector<std::string>>> {};

// The body is really in the picture, and its depth moves the picture only.
TEST_P(DrawnBodyTest, IsDrawn) {
  const BodyScene scene(GetParam().second);
  const Outcome outcome = scene.run("run", scene.out());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(fs::exists(scene.out() / "scene.mp4"));
  const Hdf5Reader mesh(scene.out() / "mesh/body.h5");
  const RowMatrixXd V = mesh.matrix("/surface/V");
  if (mesh.has("/embedding/depth")) {
    EXPECT_EQ(mesh.vector("/embedding/depth"), V.col(2));
    EXPECT_NEAR(V.col(2).maxCoeff(), 1.1, 1e-12);
    EXPECT_NEAR(V.col(2).minCoeff(), 0.9, 1e-12);
  }
  EXPECT_EQ(scene.run("run", scene.out()).code, 0);
  const json stages = json::parse(read_text_file(scene.out() / "run.json")).at("stages");
  for (const auto& [stage, entry] : stages.items()) EXPECT_EQ(entry.at("status"), "cached") << stage;
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, DrawnBodyTest,
    testing::Values(
        std::pair{"flat",
                  std::vector<std::string>{kLetter, "position: [0, 0, 1]", "triangles: {vertices: 30}",
                                           "model: {type: solid2d}", "rest_space: {type: full}"}},
        std::pair{"rod", std::vector<std::string>{kRing, "position: [0, 0, 1]", "model: {type: rod2d}",
                                                  "rest_space: {type: full}"}},
        std::pair{"shell", std::vector<std::string>{"mesh: sheet.obj", "model: {type: shell3d}",
                                                    "rest_space: {type: full}"}}),
    [](const auto& parameter) { return std::string(parameter.param.first); });

struct WrongBody {
  const char* name;
  std::vector<std::string> lines;
  std::vector<std::string> says;
};

void PrintTo(const WrongBody& c, std::ostream* stream) { *stream << c.name; }

class WrongBodyTest : public testing::TestWithParam<WrongBody> {};

TEST_P(WrongBodyTest, IsReportedWithItsPlace) {
  const BodyScene scene(GetParam().lines);
  const Outcome outcome = vivify({"check", scene.file().string()});
  EXPECT_EQ(outcome.code, 2) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  for (const std::string& part : GetParam().says) EXPECT_THAT(outcome.err, HasSubstr(part));
}

INSTANTIATE_TEST_SUITE_P(
    Bodies, WrongBodyTest,
    testing::Values(
        WrongBody{"outline_for_a_solid",
                  {kLetter},
                  {"scene.yaml:5:", "bodies[0].outline does not fit: model solid3d is made of a surface",
                   "give `mesh` instead"}},
        WrongBody{"mesh_for_a_rod",
                  {"mesh: box.obj", "model: {type: rod2d}"},
                  {":5:", "bodies[0].mesh does not fit: model rod2d is made of edges along an outline"}},
        WrongBody{"both",
                  {"mesh: box.obj", kLetter},
                  {":6:", "bodies[0].outline does not fit", "remove `outline`"}},
        WrongBody{"neither", {"scale: 1"}, {":4:", "bodies[0].mesh is missing", "add the key `mesh`"}},
        WrongBody{"no_outline",
                  {"model: {type: solid2d}"},
                  {":4:", "bodies[0].outline is missing", "add the key `outline`"}},
        WrongBody{"line_for_a_solid",
                  {kLine, "model: {type: solid2d}"},
                  {":5:", "bodies[0].outline.type = polyline does not fit", "rod2d"}},
        WrongBody{"tetrahedra_of_a_letter",
                  {kLetter, "model: {type: solid2d}", "tetrahedra: {vertices: 30}"},
                  {":7:", "bodies[0].tetrahedra does not fit", "use `triangles`"}},
        WrongBody{"triangles_of_a_rod",
                  {kLetter, "model: {type: rod2d}", "triangles: {vertices: 30}"},
                  {":7:", "bodies[0].triangles does not fit", "use `edges`"}},
        WrongBody{"extruded_solid",
                  {"mesh: box.obj", "extrude: {depth: 0.1}"},
                  {":6:", "bodies[0].extrude does not fit", "remove it"}},
        WrongBody{"turned_letter",
                  {kLetter, "model: {type: solid2d}", "heading_deg: 90"},
                  {":7:", "bodies[0].heading_deg must be 0", "controller"}},
        WrongBody{"bevel_too_wide",
                  {kLetter, "model: {type: solid2d}", "extrude: {depth: 0.1, bevel: 0.05}"},
                  {":7:", "bodies[0].extrude.bevel must be less than half the depth"}},
        WrongBody{"cage_of_points_in_space",
                  {"mesh: box.obj", "rest_space: {type: cage, points: [[0, 0], [1, 0], [0, 1]]}"},
                  {":6:", "bodies[0].rest_space.points does not fit", "`file`"}},
        WrongBody{"cage_file_in_the_plane",
                  {kLetter, "model: {type: solid2d}", "rest_space: {type: cage, file: box.obj}"},
                  {":7:", "bodies[0].rest_space.file does not fit", "`points`"}},
        WrongBody{"cage_of_two_points",
                  {kLetter, "model: {type: solid2d}", "rest_space: {type: cage, points: [[0, 0], [1, 0]]}"},
                  {":7:", "bodies[0].rest_space.points must have at least 3 corners"}},
        WrongBody{"no_examples",
                  {"mesh: box.obj", "rest_space: {type: examples}"},
                  {":6:", "bodies[0].rest_space.examples is missing"}},
        WrongBody{"example_without_pose",
                  {"mesh: box.obj", "rest_space: {type: examples, examples: [{name: lean}]}"},
                  {":6:", "bodies[0].rest_space.examples[0] needs either `file` or `pose`"}},
        WrongBody{
            "example_with_two",
            {"mesh: box.obj", "rest_space: {type: examples, examples: [{file: bent.obj, pose: lean.yaml}]}"},
            {":6:", "bodies[0].rest_space.examples[0] needs either `file` or `pose`"}},
        WrongBody{"example_that_is_missing",
                  {"mesh: box.obj", "rest_space: {type: examples, examples: [{file: none.ply}]}"},
                  {":6:", "bodies[0].rest_space.examples[0].file = none.ply: there is no file"}}),
    [](const auto& parameter) { return parameter.param.name; });

TEST(Examples, OfAnotherMeshAreThree) {
  const BodyScene solid({"mesh: box.obj", "position: [0, 0.5, 0]", "tetrahedra: {vertices: 30}",
                         "rest_space: {type: examples, examples: [{file: pose.ply}]}"});
  write_ply(solid.file().parent_path() / "pose.ply", box_mesh({1, 1, 1}));
  Outcome outcome = solid.run("weights", solid.out());
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("scene.yaml:8:"));
  EXPECT_THAT(outcome.err, HasSubstr("pose.ply has 8 vertices and the simulation mesh has "));

  const BodyScene shell({"mesh: sheet.obj", "model: {type: shell3d}",
                         "rest_space: {type: examples, examples: [{file: box.obj}]}"});
  outcome = shell.run("weights", shell.out());
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("box.obj has other triangles than the body"));
}

TEST(Examples, PoseFilesAreCheckedWithTheScene) {
  const BodyScene scene({"mesh: box.obj", "rest_space: {type: examples, examples: [{pose: lean.yaml}]}"});
  scene.write("lean.yaml", "version: 1\nhandles:\n  - {region: {min: [0, 0, 0], max: [1, 1, 1]}}\n");
  const Outcome outcome = vivify({"check", scene.file().string()});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("lean.yaml:3:"));
}

TEST(Examples, PoseIsSolvedAgainWhenItsFileChanges) {
  const BodyScene scene({kLetter, "triangles: {vertices: 30}", "model: {type: solid2d}",
                         "rest_space: {type: examples, examples: [{pose: lean.yaml}]}"});
  ASSERT_EQ(scene.run("weights", scene.out()).code, 0);
  const RowMatrixXd pose = Hdf5Reader(scene.out() / "weights/body.h5").matrix("/examples/0/V");
  const RowMatrixXd rest = Hdf5Reader(scene.out() / "mesh/body.h5").matrix("/X0");
  EXPECT_NEAR((pose - rest).col(0).maxCoeff(), 0.2, 0.02);
  std::string text = kLean;
  scene.write("lean.yaml", text.replace(text.find("0.2, 0, 0"), 9, "0.1, 0, 0"));
  ASSERT_EQ(scene.run("weights", scene.out()).code, 0);
  const RowMatrixXd again = Hdf5Reader(scene.out() / "weights/body.h5").matrix("/examples/0/V");
  EXPECT_NEAR((again - rest).col(0).maxCoeff(), 0.1, 0.02);
}

TEST(Check, WarnsOfMaterialsWithoutFailing) {
  const BodyScene scene({kLetter, "model: {type: solid2d, stiffness: 1000, volume_stiffness: 100}"});
  const Outcome outcome = vivify({"check", scene.file().string()});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("scene.yaml:6:"));
  EXPECT_THAT(outcome.err, HasSubstr("warning: bodies[0].model: volume_stiffness is below"));
}

TEST(Check, RefusesHeadingsOutOfThePlane) {
  const BodyScene scene({kLetter, "model: {type: solid2d}", "controller: {type: hop, heading_deg: 0}"});
  const Outcome outcome = vivify({"check", scene.file().string()});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("scene.yaml:7:"));
  EXPECT_THAT(outcome.err, HasSubstr("bodies[0].controller.heading_deg leads out of the plane"));
  EXPECT_THAT(outcome.err, HasSubstr("90 is to the right"));
}

TEST(Shells, WarnOfSlenderTriangles) {
  const BodyScene scene({"mesh: sliver.obj", "model: {type: shell3d}", "rest_space: {type: full}"});
  scene.write("sliver.obj", "v 0 1 0\nv 1 1 0\nv 0.5 1.01 0\nv 0.5 2 0\nf 1 2 3\nf 1 3 4\nf 3 2 4\n");
  const Outcome outcome = scene.run("mesh", scene.out());
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.err,
              HasSubstr("warning: body: triangles of the shell are up to 100 times as long as wide"));
  const Outcome remeshed =
      scene.run("mesh", scene.out("again"), {"--set", "bodies.body.triangles.vertices=40"});
  EXPECT_EQ(remeshed.code, 0) << remeshed.err;
  EXPECT_THAT(remeshed.err, testing::Not(HasSubstr("as long as wide")));
}

TEST(Check, NamesTheControllersThatHaveAKey) {
  const BodyScene scene({kLetter, "model: {type: solid2d}", "controller: {heading_deg: 90}"});
  const Outcome outcome = vivify({"check", scene.file().string()});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("it is a key of type: hop, roll, walk or crawl"));
}

TEST(Check, ReadsScripts) {
  const BodyScene scene(
      {kLetter, "model: {type: solid2d}",
       "behavior: [{hop: {to: [1, 0, 0], heading_deg: 90}}, {roll: {chase: nobody}},"
       " {wait: {until: no_one.arrived}}, {hop: {heading_deg: 20}}, {wait: {until: soon}},"
       " {turn: {by_deg: 90}}, {pose: {example: bow}},"
       " {goals: {period_s: 1, goals: [{along: [0, 0, 0], keys: [{t: 2}, {t: 1}]}]}}, {hop: {flee: body}}]"});
  const Outcome outcome = vivify({"check", scene.file().string()});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("bodies[0].behavior[0].hop.heading_deg and .to are two courses"));
  EXPECT_THAT(outcome.err, HasSubstr("bodies[0].behavior[1].roll.chase = nobody: there is no such body"));
  EXPECT_THAT(outcome.err, HasSubstr("bodies[0].behavior[2].wait.until = no_one: there is no such body"));
  EXPECT_THAT(outcome.err, HasSubstr("bodies[0].behavior[3].hop.heading_deg leads out of the plane"));
  EXPECT_THAT(outcome.err, HasSubstr("until = soon must be NAME.arrived"));
  EXPECT_THAT(outcome.err, HasSubstr("bodies[0].behavior[5].turn: a body of the plane cannot turn"));
  EXPECT_THAT(outcome.err,
              HasSubstr("bodies[0].behavior[6].pose.example = bow: the body has no such example"));
  EXPECT_THAT(outcome.err, HasSubstr("bodies[0].behavior[7].goals.goals[0].along must not be 0"));
  EXPECT_THAT(outcome.err, HasSubstr("bodies[0].behavior[7].goals.goals[0].keys has a time after period_s"));
  EXPECT_THAT(outcome.err,
              HasSubstr("bodies[0].behavior[7].goals.goals[0].keys must be in the order of time"));
  EXPECT_THAT(outcome.err, HasSubstr("bodies[0].behavior[8].hop.flee = body is the body itself"));
  const BodyScene both({kLetter, "model: {type: solid2d}", "controller: {type: hop}", "behavior: [wait:]"});
  EXPECT_THAT(vivify({"check", both.file().string()}).err,
              HasSubstr("bodies[0].controller and .behavior both say what the body does"));
}

TEST(Check, TriesCameraAndLights) {
  const BodyScene scene({"mesh: box.obj"});
  std::string text = read_text_file(scene.file());
  text.replace(text.find("position: [0, 1, 4]"), 19, "position: [0, 0.5, 0]");
  text += "lights:\n  - {type: area, position: [0, 4, 0], target: [0, 0, 0], size: [0, 1]}\n";
  scene.write("scene.yaml", text);
  const Outcome outcome = vivify({"check", scene.file().string()});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("scene.yaml:8:"));
  EXPECT_THAT(outcome.err, HasSubstr("the camera's position and target are the same point"));
  EXPECT_THAT(outcome.err, HasSubstr("scene.yaml:11:"));
  EXPECT_THAT(outcome.err, HasSubstr("an area light's size must be positive"));
}

}  // namespace
}  // namespace vivify::pipeline
