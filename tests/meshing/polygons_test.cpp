#include "meshing/polygons.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/rng.h"
#include "tests/meshing/plane_shapes.h"

namespace vivify::meshing {
namespace {

double area_of(const std::vector<Points2>& loops) {
  double sum = 0;
  for (const Points2& loop : loops) sum += signed_area(loop);
  return sum;
}

TEST(Fill, KeepsTheBitsOfACleanPolygonAndTurnsIt) {
  const Points2 square = shapes::polygon({{0.1, 0.2}, {0.1, 1.3}, {0.7, 1.3}, {0.7, 0.2}});  // clockwise
  const std::vector<Points2> loops = fill({square}, FillRule::even_odd);
  ASSERT_EQ(loops.size(), 1U);
  EXPECT_EQ(loops[0], shapes::polygon({{0.1, 0.2}, {0.7, 0.2}, {0.7, 1.3}, {0.1, 1.3}}));
}

TEST(Fill, BowTieBecomesTwoTriangles) {
  const std::vector<Points2> loops =
      fill({shapes::polygon({{0, 0}, {2, 2}, {2, 0}, {0, 2}})}, FillRule::even_odd);
  ASSERT_EQ(loops.size(), 2U);
  for (const Points2& loop : loops) {
    EXPECT_EQ(loop.rows(), 3);
    EXPECT_NEAR(signed_area(loop), 1, 1e-8);
  }
}

TEST(Fill, RulesDifferWhereContoursOverlap) {
  const std::vector<Points2> contours = {shapes::rectangle({0, 0}, {3, 3}), shapes::rectangle({1, 1}, {2, 2}),
                                         shapes::rectangle({2.5, 1}, {4, 2})};
  EXPECT_NEAR(area_of(fill(contours, FillRule::nonzero)), 10, 1e-8);
  const std::vector<Points2> even_odd = fill(contours, FillRule::even_odd);
  EXPECT_NEAR(area_of(even_odd), 9 - 1 - 0.5 + 1, 1e-8);
  int holes = 0;
  for (const Points2& loop : even_odd) holes += signed_area(loop) < 0;
  EXPECT_GE(holes, 1);
}

TEST(Fill, LeavesNothingOfALine) {
  EXPECT_TRUE(fill({shapes::polygon({{0, 0}, {1, 1}, {2, 2}})}, FillRule::nonzero).empty());
  EXPECT_TRUE(fill({shapes::polygon({{1, 1}, {1, 1}, {1, 1}})}, FillRule::nonzero).empty());
}

// Random closed zigzags: at random points, what is filled agrees with the winding of the zigzag itself, and
// the result is simple.
TEST(Fill, AgreesWithTheWindingNumberOfRandomContours) {
  CounterRng rng(3);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<Points2> contours(2);
    for (Points2& contour : contours) {
      contour.resize(9, 2);
      for (Eigen::Index i = 0; i < 9; ++i) contour.row(i) << rng.uniform(-1, 1), rng.uniform(-1, 1);
    }
    for (const FillRule rule : {FillRule::nonzero, FillRule::even_odd}) {
      const std::vector<Points2> loops = fill(contours, rule);
      for (int k = 0; k < 200; ++k) {
        const Eigen::Vector2d p(rng.uniform(-1, 1), rng.uniform(-1, 1));
        if (distance_to(contours, p) < 1e-6) continue;
        const int winding = winding_number(contours, p);
        EXPECT_EQ(winding_number(loops, p),
                  (rule == FillRule::nonzero ? winding != 0 : winding % 2 != 0) ? 1 : 0);
      }
    }
  }
}

TEST(Offset, GrowsASquareWithRoundCorners) {
  const std::vector<Points2> square = {shapes::rectangle({0, 0}, {1, 1})};
  EXPECT_NEAR(area_of(offset(square, 0.25, 1e-4)), 1 + 4 * 0.25 + std::numbers::pi / 16, 2e-3);
  EXPECT_NEAR(area_of(offset(square, -0.25, 1e-4)), 0.25, 1e-6);
  EXPECT_TRUE(offset(square, -0.6, 1e-4).empty());
}

TEST(MeetingEdges, FindsCrossingsTouchesAndSpikes) {
  EXPECT_EQ(meeting_edges({shapes::u_polygon()}).first, -1);
  EXPECT_EQ(meeting_edges({shapes::polygon({{0, 0}, {2, 2}, {2, 0}, {0, 2}})}), std::pair(0, 2));
  EXPECT_EQ(meeting_edges({shapes::polygon({{0, 0}, {2, 0}, {2, 2}, {1, 0}, {0, 2}})}), std::pair(0, 2));
  EXPECT_EQ(meeting_edges({shapes::polygon({{0, 0}, {2, 0}, {1, 0}, {1, 1}})}), std::pair(0, 1));
  EXPECT_EQ(meeting_edges({shapes::rectangle({0, 0}, {1, 1}), shapes::rectangle({1, 0.5}, {2, 2})}).first, 1);
}

TEST(TurningAngles, SumToAFullTurn) {
  const Eigen::VectorXd angles = turning_angles(shapes::u_polygon());
  EXPECT_NEAR(angles.sum(), 2 * std::numbers::pi, 1e-12);
  EXPECT_NEAR(angles.minCoeff(), -std::numbers::pi / 2, 1e-12);
}

}  // namespace
}  // namespace vivify::meshing
