#include "meshing/planar_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <set>

#include "common/error.h"
#include "meshing/quality.h"
#include "meshing/refine_plane.h"
#include "tests/meshing/plane_shapes.h"

namespace vivify::meshing {
namespace {

using shapes::glyph;
using shapes::outline_of;

std::vector<std::pair<int, int>> boundary_edges(const Triangles& F) {
  std::set<std::pair<int, int>> directed;
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_TRUE(directed.emplace(F(f, k), F(f, (k + 1) % 3)).second) << "not oriented alike";
    }
  }
  std::vector<std::pair<int, int>> edges;
  for (const auto& [a, b] : directed) {
    if (!directed.contains({b, a})) edges.emplace_back(a, b);
  }
  return edges;
}

// Every vertex used once in order, every triangle positive, the boundary near the outline, corners kept, and
// as many loops as the outline has.
void expect_good_mesh(const PlanarMesh& mesh, const Outline& outline, int vertices) {
  EXPECT_NEAR(static_cast<double>(mesh.V.rows()), vertices, 0.15 * vertices);
  EXPECT_GT(mesh.min_angle, 20);
  double area = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Eigen::Vector2d a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)),
                          c = mesh.V.row(mesh.F(f, 2));
    EXPECT_GT(cross2(b - a, c - a), 0);
    area += cross2(b - a, c - a) / 2;
  }
  EXPECT_NEAR(mesh.area_ratio, area / outline.area(), 1e-12);
  EXPECT_NEAR(mesh.area_ratio, 1, 0.06);
  EXPECT_TRUE(is_manifold(mesh.F));
  EXPECT_EQ(euler_characteristic(mesh.F), [&] {
    int sum = 0;
    for (const Points2& loop : outline.loops) sum += signed_area(loop) > 0 ? 1 : -1;
    return sum;
  }());
  std::set<std::pair<double, double>> places;
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) places.emplace(mesh.V(v, 0), mesh.V(v, 1));
  EXPECT_EQ(static_cast<Eigen::Index>(places.size()), mesh.V.rows());
  for (const Points2& loop : outline.loops) {
    const Eigen::VectorXd turns = turning_angles(loop);
    for (Eigen::Index i = 0; i < loop.rows(); ++i) {
      if (std::abs(turns[i]) > std::numbers::pi / 6) {
        EXPECT_TRUE(places.contains({loop(i, 0), loop(i, 1)})) << "corner " << i << " is missing";
      }
    }
  }
  const double spacing = std::sqrt(outline.area() / vertices);
  for (const auto& [a, b] : boundary_edges(mesh.F)) {
    const Eigen::Vector2d middle = (mesh.V.row(a) + mesh.V.row(b)) / 2;
    EXPECT_LT(distance_to(outline.loops, middle), 0.2 * spacing);
  }
}

TEST(TriangulateOutline, LettersFromFewToManyVertices) {
  for (const char* text : {"I", "o", "S", "8", "A", "&", "i"}) {
    const Outline outline = glyph(text);
    for (const int vertices : {50, 130, 2000}) {
      SCOPED_TRACE(std::string(text) + " with " + std::to_string(vertices));
      expect_good_mesh(triangulate_outline(outline, vertices), outline, vertices);
    }
  }
}

TEST(TriangulateOutline, SmallestAndLargest) {
  const Outline outline = outline_of({shapes::letter_i()});
  expect_good_mesh(triangulate_outline(outline, 20), outline, 20);
  expect_good_mesh(triangulate_outline(outline, 20000), outline, 20000);
}

TEST(TriangulateOutline, HolesWithinHolesAndTouchingLoops) {
  const Outline rings = outline_of({shapes::rectangle({0, 0}, {5, 5}), shapes::rectangle({1, 1}, {4, 4}),
                                    shapes::rectangle({2, 2}, {3, 3})});
  expect_good_mesh(triangulate_outline(rings, 100), rings, 100);
  const Outline touching = outline_of({shapes::rectangle({0, 0}, {1, 1}), shapes::rectangle({1, 1}, {2, 2})});
  const PlanarMesh mesh = triangulate_outline(touching, 60);
  EXPECT_NEAR(mesh.area_ratio, 1, 1e-9);
  EXPECT_GT(mesh.min_angle, 20);
}

// The angle of the outline itself is the bound there.
TEST(TriangulateOutline, SharpCornersStay) {
  const Outline wedge = outline_of({shapes::polygon({{0, 0}, {4, 0}, {4, 0.6}})});  // 8.5 degrees
  const PlanarMesh mesh = triangulate_outline(wedge, 100);
  EXPECT_NEAR(mesh.area_ratio, 1, 1e-12);
  EXPECT_GT(mesh.min_angle, 6);
  EXPECT_LT(mesh.min_angle, 8.6);
}

TEST(TriangulateOutline, ScaleAndPlaceDoNotMatter) {
  Outline outline = glyph("a");
  const PlanarMesh here = triangulate_outline(outline, 120);
  for (Points2& loop : outline.loops)
    loop = ((1e-6 * loop).rowwise() + Eigen::RowVector2d(3e-3, 7e-3)).eval();
  const PlanarMesh there = triangulate_outline(outline, 120);
  EXPECT_NEAR(here.min_angle, there.min_angle, 8);
  EXPECT_NEAR(static_cast<double>(there.V.rows()), 120, 18);
}

TEST(TriangulateOutline, SameBitsOnEveryRun) {
  const Outline outline = glyph("8");
  const PlanarMesh first = triangulate_outline(outline, 300);
  const auto other_heap = std::make_unique<std::vector<std::vector<char>>>(1000, std::vector<char>(48));
  const PlanarMesh second = triangulate_outline(outline, 300);
  EXPECT_EQ(first.V, second.V);
  EXPECT_EQ(first.F, second.F);
}

TEST(TriangulateOutline, TooFewVerticesIsAnError) {
  try {
    triangulate_outline(glyph("@"), 20);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::geometry);
    EXPECT_NE(std::string(error.what()).find("cannot be meshed with 20 vertices; the nearest is"),
              std::string::npos)
        << error.what();
  }
}

TEST(RefinePlane, KeepsPointsAndSegments) {
  Points2 points(7, 2);
  points << 0, 0, 1, 0, 1, 1, 0, 1, 0.3, 0.4, 0.3, 0.4, 5, 5;
  Edges segments(4, 2);
  segments << 0, 1, 1, 2, 2, 3, 3, 0;
  const auto mesh = refine_plane(points, segments, {.longest_edge = 0.2});
  ASSERT_TRUE(mesh.has_value());
  for (Eigen::Index i = 0; i < 7; ++i) EXPECT_EQ(mesh->V.row(mesh->point[i]), points.row(i));
  EXPECT_EQ(mesh->point[4], mesh->point[5]);
  EXPECT_LT(mesh->F.rows() > 0 ? (mesh->F.array() == mesh->point[6]).count() : 1, 1);
  double area = 0, longest = 0;
  for (Eigen::Index f = 0; f < mesh->F.rows(); ++f) {
    const Eigen::Vector2d a = mesh->V.row(mesh->F(f, 0)), b = mesh->V.row(mesh->F(f, 1)),
                          c = mesh->V.row(mesh->F(f, 2));
    area += cross2(b - a, c - a) / 2;
    longest = std::max({longest, (a - b).norm(), (b - c).norm(), (c - a).norm()});
  }
  EXPECT_NEAR(area, 1, 1e-12);
  EXPECT_LE(longest, 0.2 * (1 + 1e-9));
  EXPECT_GE(min_angle(mesh->V, mesh->F), 20.7);
  EXPECT_FALSE(refine_plane(points, segments, {.longest_edge = 0.01, .most_vertices = 100}).has_value());
  EXPECT_THROW(refine_plane(points, segments.topRows(3), {.longest_edge = 0.2}), Error);
}

}  // namespace
}  // namespace vivify::meshing
