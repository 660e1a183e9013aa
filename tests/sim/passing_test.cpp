// What a sliding body passes by: edges that it gets over, and the sides of bodies in a row.
#include "sim/contact/passing.h"

#include <gtest/gtest.h>

#include "tests/sim/contact_shapes.h"

namespace vivify::sim {
namespace {

using Eigen::Vector3d;

// Cubes of edge 2; a pair of the corner of `a` at `corner` with `b`.
SurfacePair pair_of_corner(const SurfaceState& a, const SurfaceState& b, const Vector3d& corner) {
  for (const SurfacePair& pair : near_pairs(a, b, 1)) {
    if (pair.kind == SurfacePair::point_face && (a.point(pair.feature_a) - corner).norm() < 1e-9) return pair;
  }
  ADD_FAILURE() << "the corner is not near";
  return {};
}

struct Placed {
  explicit Placed(const Vector3d& shift)
      : surface(surface_of(cube().moved(shift).V, cube().F)), state(surface) {}
  ContactSurface surface;
  SurfaceState state;
};

TEST(Passing, APointThatGetsOverAnEdgeIsOfTheFaceBehindIt) {
  const Placed floor({0, 0, 0}), slider({-2.2, 2.01, 0.3});
  const Vector3d corner(-1.2, 1.01, -0.7);
  const SurfacePair before = pair_of_corner(slider.state, floor.state, corner);
  EXPECT_LT(before.normal.x(), -0.9);
  SurfacePair pair = before;
  follow_passing(pair, slider.state, floor.state, {0.5, 0, 0}, 0.001);
  EXPECT_NEAR((pair.normal - Vector3d::UnitY()).norm(), 0, 1e-12);
  const Vector3d place = place_of(floor.state, pair.b, pair.weight_b);
  EXPECT_NEAR((place - Vector3d(-0.7, 1, -0.7)).norm(), 0, 1e-12);
  EXPECT_EQ(pair.distance, before.distance);
}

TEST(Passing, APointOfTheFloorIsFollowedAlike) {
  const Placed floor({0, 0, 0}), slider({-2.2, 2.01, 0.3});
  SurfacePair seen;
  bool found = false;
  for (const SurfacePair& pair : near_pairs(slider.state, floor.state, 1)) {
    if (pair.kind != SurfacePair::face_point || floor.state.point(pair.feature_b).z() < 0) continue;
    seen = pair;
    found = true;
  }
  ASSERT_TRUE(found);
  EXPECT_LT(seen.normal.x(), -0.9);
  follow_passing(seen, slider.state, floor.state, {0.5, 0, 0}, 0.001);
  EXPECT_NEAR((seen.normal - Vector3d::UnitY()).norm(), 0, 1e-12);
  EXPECT_NEAR(place_of(slider.state, seen.a, seen.weight_a).x(), -1.5, 1e-12);
}

TEST(Passing, APointThatRunsIntoAFaceKeepsIt) {
  const Placed floor({0, 0, 0});
  for (const Vector3d& shift : {Vector3d(-2.2, 1.9, 0.3), Vector3d(-2.2, 2, 0.3)}) {  // or along the top
    const Placed slider(shift);
    const SurfacePair before = pair_of_corner(slider.state, floor.state, shift + Vector3d(1, -1, -1));
    SurfacePair pair = before;
    follow_passing(pair, slider.state, floor.state, {0.5, 0, 0}, 0.001);
    EXPECT_EQ(pair.normal, before.normal);
    EXPECT_EQ(pair.weight_b, before.weight_b);
  }
}

TEST(Passing, APointThatIsFastEnoughToComeOutBehindDoesNotPass) {
  const Placed floor({0, 0, 0});
  for (const double rise : {-0.2, 0.9}) {  // straight through; over the first edge and out of the back
    const Placed bullet({-2.2, 1.2, 0.3});
    const SurfacePair before = pair_of_corner(bullet.state, floor.state, {-1.2, 0.2, -0.7});
    SurfacePair pair = before;
    follow_passing(pair, bullet.state, floor.state, {2.5, rise, 0}, 0.001);
    EXPECT_EQ(pair.normal, before.normal);
    EXPECT_EQ(pair.weight_b, before.weight_b);
  }
}

TEST(Passing, TheSidesOfFlushBodiesAreCovered) {
  const Placed body({0, 0, 0});
  const Vector3d edge(-1, 1, 0.2), left = -Vector3d::UnitX();
  const auto covered = [&](const Vector3d& y, const Vector3d& n, const Vector3d& cover) {
    return is_covered(y, n, body.state, Placed(cover).state, 0.01);
  };
  EXPECT_TRUE(covered(edge, left, {-2, 0, 0}));
  EXPECT_TRUE(covered(edge, left, {-2.003, -0.003, 0}));       // a gap and a ledge smaller than half the step
  EXPECT_FALSE(covered(edge, left, {-2, -0.01, 0}));           // a ledge that is too high
  EXPECT_FALSE(covered(edge, left, {-2.02, 0, 0}));            // a gap that is too wide
  EXPECT_FALSE(covered(edge, Vector3d::UnitY(), {-2, 0, 0}));  // from above
  EXPECT_FALSE(covered({0.2, 1, 0.2}, left, {2, 0, 0}));       // far from the cover
}

TEST(Passing, InnerCornersAreNot) {
  const Placed floor({0, 0, 0});
  const Placed wall({-1, 2, 0});  // stands on the floor; its side is at x = 0
  EXPECT_FALSE(is_covered({0.001, 1, 0.2}, Vector3d::UnitY(), floor.state, wall.state, 0.01));
  EXPECT_FALSE(is_covered({0, 1.001, 0.2}, Vector3d::UnitX(), wall.state, floor.state, 0.01));
}

}  // namespace
}  // namespace vivify::sim
