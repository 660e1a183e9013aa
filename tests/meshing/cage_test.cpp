#include "meshing/cage.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <functional>

#include "common/error.h"
#include "common/file.h"
#include "common/mesh_io.h"
#include "meshing/collapse.h"
#include "meshing/enclosure.h"
#include "meshing/harmonic.h"
#include "meshing/surface_checks.h"
#include "meshing/tapered_box.h"
#include "meshing/wrap.h"
#include "tests/meshing/cage_shapes.h"

namespace vivify::meshing {
namespace {

struct Shape {
  std::string name;
  TriangleMesh mesh;
};

std::vector<Shape> shapes_to_enclose() {
  return {
      {"sphere", shapes::sphere({3, -2, 1}, 0.5, 2)},
      {"torus", shapes::torus(1, 0.4, 20, 10)},
      {"two blobs", shapes::joined(shapes::sphere({0, 0, 0}, 0.5, 2), shapes::sphere({1.3, 0.4, 0}, 0.6, 2))},
      {"box", shapes::refined(shapes::box({0, 0, 0}, {1, 2, 0.5}), 2)}};
}

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::geometry);
    EXPECT_NE(error.hint(), "");
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return {};
}

TEST(Cage, HasTheWantedNumberOfVerticesAndEncloses) {
  for (const Shape& shape : shapes_to_enclose()) {
    const double diagonal = bounding_box(shape.mesh.V).diagonal();
    double last_volume = 1e300;
    for (const int wanted : {8, 20, 60}) {
      SCOPED_TRACE(shape.name + " in " + std::to_string(wanted));
      const TriangleMesh cage = make_cage(shape.mesh.V, shape.mesh, {.vertices = wanted, .clearance = 0.02});
      EXPECT_EQ(cage.V.rows(), wanted);
      EXPECT_EQ(topology_problem(cage), "");
      EXPECT_EQ(component_count(cage), 1);
      EXPECT_TRUE(self_intersections(cage).empty());
      EXPECT_TRUE(points_not_inside(cage, shape.mesh.V, 0.0199 * diagonal).empty());
      EXPECT_GT(signed_volume(cage), signed_volume(shape.mesh));
      if (wanted > 8) {
        EXPECT_LT(signed_volume(cage), last_volume) << "more vertices must fit better";
      }
      last_volume = wanted == 8 ? 1e300 : signed_volume(cage);
    }
  }
}

TEST(Cage, SameOnEveryCall) {
  const TriangleMesh torus = shapes::torus(1, 0.4, 20, 10);
  const TriangleMesh one = make_cage(torus.V, torus, {.vertices = 20}),
                     two = make_cage(torus.V, torus, {.vertices = 20});
  EXPECT_EQ(one.V, two.V);
  EXPECT_EQ(one.F, two.F);
}

TEST(Cage, KeepsAHandleWhenThereAreVerticesForIt) {
  const TriangleMesh torus = shapes::torus(1, 0.25, 24, 8);
  const TriangleMesh cage = make_cage(torus.V, torus, {.vertices = 100});
  EXPECT_EQ(cage.V.rows() - cage.F.rows() / 2, 0);  // Euler number of a torus
  EXPECT_LT(winding_number(cage, {0, 0, 0}), 0.5);
}

TEST(Cage, HarmonicCoordinatesWorkInIt) {
  const TriangleMesh torus = shapes::torus(1, 0.4, 12, 6);
  for (const int wanted : {8, 30}) {
    const TriangleMesh cage = make_cage(torus.V, torus, {.vertices = wanted});
    const Eigen::MatrixXd weights = harmonic_coordinates(cage, torus.V, {.unknowns = 3000});
    EXPECT_GE(weights.minCoeff(), 0);
    EXPECT_LE((weights * cage.V - torus.V).cwiseAbs().maxCoeff(), 1e-10);
  }
}

TEST(TaperedBox, IsTightAroundAFrustum) {
  // A frustum with given taper; the box must find it again, enlarged by the clearance only.
  Points frustum(8, 3);
  for (int i = 0; i < 8; ++i) {
    const bool top = i & 2;
    frustum.row(i) << (i & 1 ? 1 : -1) * (top ? 0.5 : 1.0), top ? 2 : 0,
        (i & 4 ? 1 : -1) * (top ? 0.75 : 0.5);
  }
  TriangleMesh exact = tapered_box(frustum, 1e-9);
  EXPECT_EQ(topology_problem(exact), "");
  EXPECT_TRUE(points_not_inside(exact, frustum).empty());
  EXPECT_LT(signed_volume(exact) / (2 * 4 * (1.0 * 0.5 + (1.0 * 0.25 - 0.5 * 0.5) / 2 - 0.5 * 0.25 / 3)),
            1.02);
}

TEST(TaperedBox, KeepsTheClearanceAndFollowsATurnedCharacter) {
  const Eigen::AngleAxisd turn(0.5, Eigen::Vector3d::UnitY());
  Points points = shapes::random_points(500, {-1, 0, -0.2}, {1, 1, 0.2}, 21);
  const double upright = signed_volume(tapered_box(points, 0.05));
  points = (points * turn.toRotationMatrix().transpose()).eval();
  const TriangleMesh box = tapered_box(points, 0.05);
  EXPECT_LT(signed_volume(box), 1.05 * upright);
  EXPECT_TRUE(points_not_inside(box, points, 0.05 * (1 - 1e-9)).empty());
}

TEST(TaperedBox, IsSymmetricAroundASymmetricCharacter) {
  const TriangleMesh cone = [] {
    TriangleMesh mesh = shapes::sphere({0, 0, 0}, 1);
    mesh.V.col(0).array() *= 1 - 0.4 * mesh.V.col(1).array();
    return mesh;
  }();
  const TriangleMesh box = tapered_box(cone.V, 0.05);
  for (int i = 0; i < 8; ++i) {
    EXPECT_NEAR(box.V(i, 0), -box.V(i ^ 1, 0), 1e-12);
    EXPECT_NEAR(box.V(i, 2), -box.V(i ^ 4, 2), 1e-12);
  }
  // Mirror images have mirrored weights.
  Points points(2, 3);
  points << 0.2, 0.1, -0.3, -0.2, 0.1, -0.3;
  const Eigen::MatrixXd weights = harmonic_coordinates(box, points, {.unknowns = 4000});
  for (int i = 0; i < 8; ++i) EXPECT_NEAR(weights(0, i), weights(1, i ^ 1), 5e-3);
}

TEST(Collapse, NeverTouchesWhatItEncloses) {
  const TriangleMesh torus = shapes::torus(1, 0.4);
  const TriangleMesh start = wrap_surface(torus, 0.15, 0.05);
  for (const int wanted : {100, 40, 4}) {
    const TriangleMesh result = collapse_around(start, torus, wanted);
    EXPECT_LT(result.V.rows(), start.V.rows());
    EXPECT_EQ(result.V.rows() - result.F.rows() / 2, 0);  // still a torus
    EXPECT_EQ(topology_problem(result), "");
    EXPECT_TRUE(self_intersections(shapes::joined(result, torus)).empty());
    EXPECT_TRUE(points_not_inside(result, torus.V).empty());
  }
}

TEST(ValidateCage, TurnsAnInvertedCageOutward) {
  TriangleMesh cage = shapes::box({0, 0, 0}, {1, 1, 1});
  const Triangles outward = cage.F;
  cage.F = cage.F.rowwise().reverse().eval();
  const TriangleMesh fixed = validate_cage(cage, Points::Constant(1, 3, 0.5));
  EXPECT_EQ(fixed.F, outward);
  EXPECT_EQ(fixed.V, cage.V);
}

TEST(ValidateCage, ListsTheVerticesOutside) {
  const TriangleMesh cage = shapes::box({0, 0, 0}, {1, 1, 1});
  Points points = Points::Constant(9, 3, 0.5);
  for (const int i : {2, 3, 4, 5, 6, 8}) points(i, 1) = 1.5;
  const std::string message = message_of([&] { validate_cage(cage, points); });
  EXPECT_NE(message.find("6 of 9"), std::string::npos) << message;
  EXPECT_NE(message.find("vertices 2, 3, 4, 5, 6 and 1 more"), std::string::npos) << message;
}

TEST(ValidateCage, AsksForClearance) {
  const TriangleMesh cage = shapes::box({0, 0, 0}, {1, 1, 1});
  Points points(1, 3);
  points << 0.5, 0.5, 0.95;
  EXPECT_NO_THROW(validate_cage(cage, points, 0.04));
  EXPECT_NE(message_of([&] { validate_cage(cage, points, 0.06); }).find("nearer"), std::string::npos);
}

TEST(ValidateCage, RejectsBrokenSurfaces) {
  const Points inside = Points::Constant(1, 3, 0.5);
  const TriangleMesh box = shapes::box({0, 0, 0}, {1, 1, 1});

  TriangleMesh open = box;
  open.F.conservativeResize(11, 3);
  EXPECT_NE(message_of([&] { validate_cage(open, inside); }).find("open at 3 edges"), std::string::npos);

  TriangleMesh mixed = box;
  std::swap(mixed.F(4, 0), mixed.F(4, 1));
  EXPECT_NE(message_of([&] { validate_cage(mixed, inside); }).find("oriented"), std::string::npos);

  TriangleMesh crossing = shapes::refined(box);
  Eigen::Index vertex = 0;
  (crossing.V.rowwise() - Eigen::RowVector3d(0.5, 0.5, 0)).rowwise().norm().minCoeff(&vertex);
  crossing.V(vertex, 2) = 1.5;  // the middle of the floor through the ceiling
  EXPECT_NE(message_of([&] { validate_cage(crossing, inside); }).find("intersects itself"),
            std::string::npos);

  TriangleMesh pinched = shapes::joined(box, shapes::box({1, 1, 1}, {2, 2, 2}));
  pinched.F = pinched.F.unaryExpr([](int v) { return v == 8 ? 7 : v; });
  pinched.V.row(8) = pinched.V.row(15);
  pinched.F = pinched.F.unaryExpr([](int v) { return v == 15 ? 8 : v; });
  pinched.V.conservativeResize(15, 3);
  EXPECT_NE(message_of([&] { validate_cage(pinched, inside); }).find("touch only in vertex 7"),
            std::string::npos);

  TriangleMesh infinite = box;
  infinite.V(3, 1) = std::numeric_limits<double>::infinity();
  EXPECT_NE(message_of([&] { validate_cage(infinite, inside); }).find("not finite"), std::string::npos);
}

// A file whose faces do not share vertices, as texture seams make it.
TEST(Cage, FromAFileKeepsItsShape) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "vivify_cage_test.off";
  const TriangleMesh box = shapes::box({0, 0, 0}, {1, 1, 2});
  std::string text = "OFF\n36 12 0\n";
  for (Eigen::Index f = 0; f < 12; ++f) {
    for (int k = 0; k < 3; ++k) {
      const auto p = box.V.row(box.F(f, k));
      text += std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]) + "\n";
    }
  }
  for (int f = 0; f < 12; ++f) {
    text += "3 " + std::to_string(3 * f) + " " + std::to_string(3 * f + 1) + " " + std::to_string(3 * f + 2) +
            "\n";
  }
  write_file_atomic(file, text);
  const TriangleMesh character = shapes::sphere({0.5, 0.5, 1}, 0.3, 2);
  const TriangleMesh cage = validate_cage(read_mesh(file), character.V);
  EXPECT_EQ(cage.V.rows(), 8);
  EXPECT_EQ(cage.F.rows(), 12);
  EXPECT_NEAR(signed_volume(cage), 2, 1e-6);

  const TriangleMesh larger = shapes::sphere({0.5, 0.5, 1}, 0.6, 2);
  const std::string message = message_of([&] { validate_cage(read_mesh(file), larger.V, 0, "my cage"); });
  EXPECT_EQ(message.find("my cage"), 0u) << message;
  EXPECT_NE(message.find("not strictly inside"), std::string::npos) << message;
  std::filesystem::remove(file);
}

TEST(Cage, SettingsComeFromTheSchema) {
  std::vector<Error> errors;
  const ConfigNode node = parse_yaml("{vertices: 20}", "scene.yaml", errors);
  const CageSettings settings = cage_settings(resolve(cage_schema(), node, errors));
  ASSERT_TRUE(errors.empty());
  EXPECT_EQ(settings.vertices, 20);
  EXPECT_EQ(settings.clearance, CageSettings().clearance);
  const ConfigNode defaults = parse_yaml("{}", "scene.yaml", errors);
  EXPECT_EQ(cage_settings(resolve(cage_schema(), defaults, errors)).vertices, 8);
}

}  // namespace
}  // namespace vivify::meshing
