#include "meshing/planar_cage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/error.h"
#include "meshing/planar_mesh.h"
#include "tests/meshing/plane_shapes.h"

namespace vivify::meshing {
namespace {

using shapes::glyph;
using shapes::outline_of;

using ::testing::HasSubstr;

double diagonal_of(const Outline& outline) { return box_of(outline.loops).diagonal().norm(); }

// A castle with two legs and battlements.
Points2 castle() {
  return shapes::polygon({{0, 0},
                          {1, 0},
                          {1, 2},
                          {3, 2},
                          {3, 0},
                          {4, 0},
                          {4, 5},
                          {3, 5},
                          {3, 4.5},
                          {2.5, 4.5},
                          {2.5, 5},
                          {1.5, 5},
                          {1.5, 4.5},
                          {1, 4.5},
                          {1, 5},
                          {0, 5}});
}

TEST(PlanarCage, EnclosesLettersWithTheWantedNumberOfVertices) {
  for (const char* text : {"I", "S", "A", "W", "i", "8"}) {
    const Outline outline = glyph(text);
    const PlanarMesh mesh = triangulate_outline(outline, 100);
    for (const int vertices : {4, 5, 8, 13, 24, 50}) {
      SCOPED_TRACE(std::string(text) + " with " + std::to_string(vertices));
      const Points2 cage = make_planar_cage(mesh.V, outline, {.vertices = vertices});
      EXPECT_EQ(cage.rows(), vertices);
      EXPECT_EQ(meeting_edges({cage}).first, -1);
      EXPECT_GT(signed_area(cage), outline.area());
      for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
        EXPECT_EQ(winding_number({cage}, mesh.V.row(v).transpose()), 1);
        EXPECT_GE(distance_to({cage}, mesh.V.row(v).transpose()), 0.019 * diagonal_of(outline));
      }
    }
  }
}

TEST(PlanarCage, FourVerticesAreASymmetricTrapezium) {
  const Outline outline = outline_of({shapes::polygon({{-2, 0}, {2, 0}, {1, 3}, {-1, 3}})});
  const Points2 cage = make_planar_cage(outline.loops[0], outline, {.vertices = 4});
  ASSERT_EQ(cage.rows(), 4);
  EXPECT_NEAR(cage(0, 0), -cage(1, 0), 1e-12);
  EXPECT_NEAR(cage(2, 0), -cage(3, 0), 1e-12);
  EXPECT_EQ(cage(0, 1), cage(1, 1));
  EXPECT_EQ(cage(2, 1), cage(3, 1));
  EXPECT_LT(cage(2, 0), 0.7 * cage(1, 0));  // it tapers with the shape
}

// With vertices enough the cage leaves the gap between the legs open; with few it does not.
TEST(PlanarCage, FollowsLegsWhenItHasTheVertices) {
  const Outline outline = outline_of({castle()});
  const auto cage = [&](int vertices) { return make_planar_cage(castle(), outline, {.vertices = vertices}); };
  const Eigen::Vector2d between(2, 1);
  EXPECT_EQ(winding_number({cage(8)}, between), 0);
  EXPECT_EQ(winding_number({cage(20)}, between), 0);
  EXPECT_EQ(winding_number({cage(5)}, between), 1);
  EXPECT_LT(signed_area(cage(8)), 1.35 * outline.area());
  EXPECT_LT(signed_area(cage(40)), 1.25 * outline.area());
}

// Vertices that the shape does not need are spread over the long edges.
TEST(PlanarCage, HasNoTinyEdges) {
  const Outline outline = outline_of({shapes::rectangle({0, 0}, {1, 4})});
  const Points2 cage = make_planar_cage(outline.loops[0], outline, {.vertices = 20});
  ASSERT_EQ(cage.rows(), 20);
  for (Eigen::Index i = 0; i < 20; ++i) {
    EXPECT_GT((cage.row(i) - cage.row((i + 1) % 20)).norm(), 0.4);
    EXPECT_LT((cage.row(i) - cage.row((i + 1) % 20)).norm(), 0.8);
  }
}

TEST(PlanarCage, PartsAndStrayPointsGetOneCage) {
  const Outline outline = outline_of({shapes::rectangle({0, 0}, {1, 1}), shapes::rectangle({3, 0}, {4, 1})});
  Points2 points = outline.loops[0];
  points.conservativeResize(5, 2);
  points.row(4) << 2, 2;
  const Points2 cage = make_planar_cage(points, outline, {.vertices = 12});
  EXPECT_EQ(cage.rows(), 12);
  for (const Eigen::Vector2d& p : {Eigen::Vector2d(2, 2), Eigen::Vector2d(0, 0), Eigen::Vector2d(4, 1)}) {
    EXPECT_EQ(winding_number({cage}, p), 1);
  }
}

TEST(ValidatePlanarCage, TurnsAClockwiseCageAndKeepsItsFirstVertex) {
  const Points2 cage = shapes::polygon({{0, 0}, {0, 2}, {2, 2}, {2, 0}});
  const Points2 turned = validate_planar_cage(cage, shapes::polygon({{1, 1}}));
  EXPECT_EQ(turned, shapes::polygon({{0, 0}, {2, 0}, {2, 2}, {0, 2}}));
}

TEST(ValidatePlanarCage, NamesWhatIsWrong) {
  const Points2 inside = shapes::polygon({{1, 1}});
  const auto message = [&](const Points2& cage, const Points2& points, double clearance) -> std::string {
    try {
      validate_planar_cage(cage, points, clearance, "cage.yaml");
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::geometry);
      return error.what();
    }
    return "no error";
  };
  const Points2 square = shapes::rectangle({0, 0}, {2, 2});
  EXPECT_EQ(message(square, inside, 0.5), "no error");
  EXPECT_THAT(message(square.topRows(2), inside, 0), HasSubstr("fewer than 3 vertices"));
  EXPECT_THAT(message(shapes::polygon({{0, 0}, {2, 2}, {2, 0}, {0, 2}}), inside, 0),
              HasSubstr("edge 0-1 meets edge 2-3"));
  EXPECT_THAT(message(shapes::polygon({{0, 0}, {2, 0}, {2, 0}, {0, 2}}), inside, 0),
              HasSubstr("vertices 1 and 2 are in the same place (2, 0)"));
  EXPECT_THAT(message(shapes::polygon({{0, 0}, {NAN, 0}, {2, 2}}), inside, 0),
              HasSubstr("vertex 1 is not finite"));
  EXPECT_THAT(
      message(square, shapes::polygon({{1, 1}, {3, 1}, {2, 1}}), 0),
      HasSubstr("2 of 3 vertices of the character are not strictly inside: vertices 1 and 2, vertex 1 "
                "at (3, 1)"));
  EXPECT_THAT(message(square, shapes::polygon({{1, 1}, {1.8, 1}}), 0.3),
              HasSubstr("1 vertices of the character are nearer to it than 0.3 m: vertices 1"));
}

}  // namespace
}  // namespace vivify::meshing
