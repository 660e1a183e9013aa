// Near features of two surfaces against brute force, closed forms, and what a local minimum of the distance
// means.
#include "sim/contact/surface_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <set>

#include "common/error.h"
#include "sim/contact/closest_points.h"
#include "tests/sim/contact_shapes.h"

namespace vivify::sim {
namespace {

using Eigen::Vector3d;

Vector3d place_of(const SurfaceState& state, const std::array<int, 3>& points,
                  const std::array<double, 3>& weights) {
  Vector3d place = Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    if (points[k] >= 0) place += weights[k] * state.point(points[k]);
  }
  return place;
}

// What every pair promises.
void expect_sound(const SurfaceState& a, const SurfaceState& b, const std::vector<SurfacePair>& pairs,
                  double reach) {
  for (const SurfacePair& pair : pairs) {
    EXPECT_NEAR(pair.normal.norm(), 1, 1e-12);
    const Vector3d y_a = place_of(a, pair.a, pair.weight_a), y_b = place_of(b, pair.b, pair.weight_b);
    EXPECT_NEAR(pair.normal.dot(y_a - y_b), pair.distance, 1e-12);
    EXPECT_NEAR((y_a - y_b).norm(), std::abs(pair.distance), 1e-12);
    EXPECT_LE(pair.distance, reach);
    for (const auto& weights : {pair.weight_a, pair.weight_b}) {
      EXPECT_NEAR(weights[0] + weights[1] + weights[2], 1, 1e-12);
      EXPECT_GE(*std::min_element(weights.begin(), weights.end()), 0);
    }
  }
  EXPECT_TRUE(std::is_sorted(pairs.begin(), pairs.end(), [](const SurfacePair& u, const SurfacePair& v) {
    return std::tie(u.kind, u.feature_a, u.feature_b) < std::tie(v.kind, v.feature_a, v.feature_b);
  }));
}

// How often the surface winds about y: 1 inside, 0 outside (solid angles, van Oosterom and Strackee 1983).
double winding(const Shape& shape, const Vector3d& y) {
  double sum = 0;
  for (Eigen::Index f = 0; f < shape.F.rows(); ++f) {
    Vector3d r[3];
    for (int k = 0; k < 3; ++k) r[k] = shape.V.row(shape.F(f, k)).transpose() - y;
    const double l[3] = {r[0].norm(), r[1].norm(), r[2].norm()};
    sum += 2 * std::atan2(r[0].dot(r[1].cross(r[2])), l[0] * l[1] * l[2] + r[0].dot(r[1]) * l[2] +
                                                          r[1].dot(r[2]) * l[0] + r[2].dot(r[0]) * l[1]);
  }
  return sum / (4 * std::numbers::pi);
}

double distance_to(const Shape& shape, const Vector3d& y) {
  double least = INFINITY;
  for (Eigen::Index f = 0; f < shape.F.rows(); ++f) {
    const auto corner = [&](int k) -> Vector3d { return shape.V.row(shape.F(f, k)).transpose(); };
    least = std::min(least, (nearest_on_triangle(y, corner(0), corner(1), corner(2)).position - y).norm());
  }
  return least;
}

std::vector<SurfacePair> of_kind(const std::vector<SurfacePair>& pairs, SurfacePair::Kind kind) {
  std::vector<SurfacePair> some;
  for (const SurfacePair& pair : pairs) {
    if (pair.kind == kind) some.push_back(pair);
  }
  return some;
}

// Two bumpy spheres that overlap, touch or miss each other.
struct TwoShapes {
  Shape a, b;
  explicit TwoShapes(int seed, double gap)
      : a(bumpy_sphere(2, 0.8, 1.2, seed)),
        b(bumpy_sphere(1, 0.8, 1.2, seed + 100)
              .moved({2 + gap, 0, 0}, Eigen::AngleAxisd(seed, Vector3d(1, 2, 3).normalized()).matrix())) {}
};

TEST(SurfacePairs, OfPointsAreThoseOfBruteForceOnRandomSurfaces) {
  for (int seed = 0; seed < 12; ++seed) {
    const TwoShapes shapes(seed, -0.8 + 0.1 * seed);
    const ContactSurface surface_a = surface_of(shapes.a.V, shapes.a.F),
                         surface_b = surface_of(shapes.b.V, shapes.b.F);
    const SurfaceState a(surface_a), b(surface_b);
    const double reach = 0.15;
    const std::vector<SurfacePair> pairs = near_pairs(a, b, reach);
    expect_sound(a, b, pairs, reach);
    int inside = 0;
    for (const bool of_a : {true, false}) {
      const Shape &points = of_a ? shapes.a : shapes.b, &surface = of_a ? shapes.b : shapes.a;
      std::map<int, double> found;
      for (const SurfacePair& pair :
           of_kind(pairs, of_a ? SurfacePair::point_face : SurfacePair::face_point)) {
        const int point = of_a ? pair.feature_a : pair.feature_b;
        EXPECT_EQ(of_a ? pair.feature_b : pair.feature_a, -1);
        EXPECT_TRUE(found.emplace(point, pair.distance).second);
      }
      for (int p = 0; p < points.V.rows(); ++p) {
        const Vector3d y = points.V.row(p).transpose();
        const double distance = distance_to(surface, y) * (winding(surface, y) > 0.5 ? -1 : 1);
        ASSERT_EQ(found.contains(p), distance <= reach) << "seed " << seed << " point " << p;
        if (distance <= reach) {
          EXPECT_NEAR(found[p], distance, 1e-12);
        }
        inside += distance < 0;
      }
    }
    if (seed < 4) {
      EXPECT_GT(inside, 5);  // these overlap
    }
  }
}

// How fast the distance from the place y of an edge to z falls, at most, on the way from y into a face around
// the edge (a sine; negative: y is the nearest place).
double fall(const Shape& shape, const RowMatrixXi& edges, int edge, const Vector3d& y, const Vector3d& z) {
  double most = -1;
  for (Eigen::Index f = 0; f < shape.F.rows(); ++f) {
    int shared = 0;
    Vector3d opposite = Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      const int p = shape.F(f, k);
      if (p == edges(edge, 0) || p == edges(edge, 1)) {
        ++shared;
      } else {
        opposite = shape.V.row(p).transpose();
      }
    }
    if (shared < 2) continue;
    const Vector3d from = shape.V.row(edges(edge, 0)).transpose(),
                   along = (shape.V.row(edges(edge, 1)).transpose() - from).normalized();
    Vector3d into = opposite - from;
    into = (into - along * along.dot(into)).normalized();
    most = std::max(most, ((y - z).norm() - (y + 1e-6 * into - z).norm()) / 1e-6);
  }
  return most;
}

// Two small polyhedra with sharp edges only, near one another.
struct TwoPolyhedra {
  Shape a, b;
  TwoPolyhedra(int seed, double gap) {
    CounterRng rng(hash_words(seed, 77));
    const auto turn = [&]() -> Eigen::Matrix3d {
      return Eigen::AngleAxisd(rng.uniform(0, 6), random_point(1, rng).normalized()).matrix();
    };
    const Eigen::Matrix3d turn_a = turn(), turn_b = turn();
    a = (seed % 2 ? tetrahedron() : bumpy_sphere(0, 0.9, 1.0, seed)).moved({0, 0, 0}, turn_a);
    b = (seed % 3 ? tetrahedron() : bumpy_sphere(0, 0.9, 1.0, seed)).moved({1.5 + gap, 0, 0}, turn_b);
  }
};

TEST(SurfacePairs, OfEdgesAreTheLocalMinimaOfTheDistance) {
  int minima = 0;
  for (int seed = 0; seed < 60; ++seed) {
    const TwoPolyhedra shapes(seed, 0.3);
    const ContactSurface surface_a = surface_of(shapes.a.V, shapes.a.F),
                         surface_b = surface_of(shapes.b.V, shapes.b.F);
    const SurfaceState a(surface_a), b(surface_b);
    const double reach = 0.5;
    std::map<std::pair<int, int>, double> found;
    for (const SurfacePair& pair : of_kind(near_pairs(a, b, reach), SurfacePair::edge_edge)) {
      found.emplace(std::pair(pair.feature_a, pair.feature_b), pair.distance);
    }
    for (int i = 0; i < surface_a.edges.rows(); ++i) {
      for (int j = 0; j < surface_b.edges.rows(); ++j) {
        const Vector3d a0 = a.point(surface_a.edges(i, 0)), a1 = a.point(surface_a.edges(i, 1));
        const Vector3d b0 = b.point(surface_b.edges(j, 0)), b1 = b.point(surface_b.edges(j, 1));
        const auto [s, t, offset] = nearest_on_segments(a0, a1, b0, b1);
        const Vector3d y_a = a0 + s * (a1 - a0), y_b = b0 + t * (b1 - b0);
        const bool between = s > 0 && s < 1 && t > 0 && t < 1 && offset.norm() <= reach;
        const double falls = std::max(fall(shapes.a, surface_a.edges, i, y_a, y_b),
                                      fall(shapes.b, surface_b.edges, j, y_b, y_a));
        const bool apart =
            winding(shapes.a, y_a - 0.01 * offset) < 0.5 && winding(shapes.b, y_b + 0.01 * offset) < 0.5;
        if (found.contains({i, j}) && found[{i, j}] > 0) {
          EXPECT_TRUE(between && apart && falls <= 0.1 + 1e-5) << seed << ": " << i << ", " << j;
          EXPECT_NEAR((found[{i, j}]), offset.norm(), 1e-12);
        }
        if (!between || !apart || falls >= 0) continue;
        EXPECT_TRUE(found.contains({i, j})) << seed << ": " << i << ", " << j;
        ++minima;
      }
    }
  }
  EXPECT_GT(minima, 20);
}

// A contact of edges goes on where it began, and a little beyond.
TEST(SurfacePairs, EdgesThatTouchedAreKeptFartherThanTheyAreFound) {
  int found = 0, kept_only = 0, dropped = 0;
  for (int seed = 0; seed < 40; ++seed) {
    const TwoShapes shapes(seed, -0.1 + 0.005 * seed);
    const ContactSurface surface_a = surface_of(shapes.a.V, shapes.a.F),
                         surface_b = surface_of(shapes.b.V, shapes.b.F);
    const SurfaceState a(surface_a), b(surface_b);
    const double reach = 0.15;
    std::map<std::pair<int, int>, SurfacePair> pairs;
    for (const SurfacePair& pair : of_kind(near_pairs(a, b, reach), SurfacePair::edge_edge))
      pairs.emplace(std::pair(pair.feature_a, pair.feature_b), pair);
    for (int i = 0; i < surface_a.edges.rows(); ++i) {
      for (int j = 0; j < surface_b.edges.rows(); ++j) {
        const auto pair = pairs.find({i, j});
        if (pair != pairs.end()) {
          ++found;
          const std::optional<SurfacePair> kept = kept_edge_pair(a, i, b, j, pair->second.normal);
          ASSERT_TRUE(kept);
          EXPECT_LE((kept->normal - pair->second.normal).norm(), 1e-12);
          EXPECT_NEAR(kept->distance, pair->second.distance, 1e-12);
          EXPECT_EQ(kept->weight_a, pair->second.weight_a);
          continue;
        }
        const SegmentPlaces places =
            nearest_on_segments(a.point(surface_a.edges(i, 0)), a.point(surface_a.edges(i, 1)),
                                b.point(surface_b.edges(j, 0)), b.point(surface_b.edges(j, 1)));
        if (places.offset.norm() > reach || places.offset.norm() < 1e-9) continue;
        const std::optional<SurfacePair> kept = kept_edge_pair(a, i, b, j, places.offset.normalized());
        ++(kept ? kept_only : dropped);
        if (kept) {
          EXPECT_FALSE(b.edge_cone_has(j, kept->normal) && a.edge_cone_has(i, -kept->normal));
        }
      }
    }
  }
  EXPECT_GT(found, 20);
  EXPECT_GT(kept_only, 5);
  EXPECT_GT(dropped, kept_only);
}

TEST(SurfacePairs, TheNearestIsTheDistanceOfTheSurfaces) {
  for (int seed = 0; seed < 20; ++seed) {
    const TwoShapes shapes(seed, 0.4);
    const ContactSurface surface_a = surface_of(shapes.a.V, shapes.a.F),
                         surface_b = surface_of(shapes.b.V, shapes.b.F);
    const SurfaceState a(surface_a), b(surface_b);
    double expected = INFINITY;
    for (int p = 0; p < shapes.a.V.rows(); ++p)
      expected = std::min(expected, distance_to(shapes.b, a.point(p)));
    for (int p = 0; p < shapes.b.V.rows(); ++p)
      expected = std::min(expected, distance_to(shapes.a, b.point(p)));
    for (int i = 0; i < surface_a.edges.rows(); ++i) {
      for (int j = 0; j < surface_b.edges.rows(); ++j) {
        const auto [s, t, offset] =
            nearest_on_segments(a.point(surface_a.edges(i, 0)), a.point(surface_a.edges(i, 1)),
                                b.point(surface_b.edges(j, 0)), b.point(surface_b.edges(j, 1)));
        expected = std::min(expected, offset.norm());
      }
    }
    double found = INFINITY;
    for (const SurfacePair& pair : near_pairs(a, b, 1)) found = std::min(found, pair.distance);
    EXPECT_NEAR(found, expected, 1e-12) << seed;
    EXPECT_TRUE(near_pairs(a, b, 0.999 * expected).empty());
  }
}

TEST(SurfacePairs, MirrorWhenTheSurfacesChangePlaces) {
  int edges = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const TwoPolyhedra shapes(trial, -0.5 + 0.01 * trial);
    const ContactSurface surface_a = surface_of(shapes.a.V, shapes.a.F),
                         surface_b = surface_of(shapes.b.V, shapes.b.F);
    const SurfaceState a(surface_a), b(surface_b);
    const std::vector<SurfacePair> pairs = near_pairs(a, b, 0.3);
    const std::vector<SurfacePair> mirror = near_pairs(b, a, 0.3);
    expect_sound(a, b, pairs, 0.3);
    ASSERT_EQ(pairs.size(), mirror.size());
    edges += static_cast<int>(of_kind(pairs, SurfacePair::edge_edge).size());
    for (const SurfacePair& pair : pairs) {
      const auto kind = pair.kind == SurfacePair::point_face   ? SurfacePair::face_point
                        : pair.kind == SurfacePair::face_point ? SurfacePair::point_face
                                                               : SurfacePair::edge_edge;
      const auto other = std::find_if(mirror.begin(), mirror.end(), [&](const SurfacePair& candidate) {
        return candidate.kind == kind && candidate.feature_a == pair.feature_b &&
               candidate.feature_b == pair.feature_a;
      });
      ASSERT_NE(other, mirror.end());
      EXPECT_EQ(other->a, pair.b);
      EXPECT_EQ(other->b, pair.a);
      EXPECT_NEAR(other->distance, pair.distance, 1e-12);
      EXPECT_LE((other->normal + pair.normal).norm(), 1e-9);
    }
  }
  EXPECT_GT(edges, 20);
}

TEST(SurfacePairs, DistancesInsideAndOutsideATetrahedron) {
  const Shape shape = tetrahedron();
  const ContactSurface surface = surface_of(shape.V, shape.F);
  const SurfaceState state(surface);
  CounterRng rng(5);
  int inside = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const Vector3d y = random_point(1, rng);
    // Its faces lie 1/3 from its middle, opposite to the corners.
    double height = -INFINITY;
    for (int k = 0; k < 4; ++k) height = std::max(height, -shape.V.row(k).dot(y) - 1.0 / 3);
    const std::optional<SurfacePlace> place = state.nearest(y, INFINITY);
    ASSERT_TRUE(place);
    EXPECT_EQ(place->distance < 0, height < 0);
    if (height < 0) {
      EXPECT_NEAR(place->distance, height, 1e-12);
      ++inside;
    }
    EXPECT_NEAR(std::abs(place->distance), distance_to(shape, y), 1e-12);
    const Vector3d ahead = y + 1e-6 * place->normal;  // the distance grows along the normal
    EXPECT_NEAR(state.nearest(ahead, INFINITY)->distance - place->distance, 1e-6, 1e-10);
  }
  EXPECT_GT(inside, 100);
}

TEST(SurfacePairs, DistancesInsideAndOutsideASphere) {
  const Shape shape = sphere(3);
  const ContactSurface surface = surface_of(shape.V, shape.F);
  const SurfaceState state(surface);
  const double sagitta = 0.006;  // of its faces, whose edges are 0.16 long at most
  CounterRng rng(6);
  for (int trial = 0; trial < 1000; ++trial) {
    const Vector3d y = random_point(1.4, rng);
    const double distance = state.nearest(y, INFINITY)->distance;
    EXPECT_GE(distance, y.norm() - 1 - 1e-12);
    EXPECT_LE(distance, y.norm() - 1 + sagitta);
  }
}

TEST(SurfacePairs, APointDeepInsideASolidStillHasItsNearestFace) {
  const Shape large = sphere(2), small = sphere(0);
  const ContactSurface outer = surface_of(large.V, large.F),
                       inner = surface_of(Points(0.1 * small.V), small.F);
  const SurfaceState a(inner), b(outer);
  const std::vector<SurfacePair> pairs = near_pairs(a, b, 0.001);
  EXPECT_EQ(pairs.size(), 12u);
  for (const SurfacePair& pair : pairs) EXPECT_LT(pair.distance, -0.8);
}

// Cubes that touch crosswise with an edge each, lifted by `gap`.
struct CrossedCubes {
  Shape lower =
      cube().moved(Vector3d::Zero(), Eigen::AngleAxisd(std::numbers::pi / 4, Vector3d::UnitZ()).matrix());
  Shape upper;
  explicit CrossedCubes(double gap)
      : upper(cube().moved({0, 2 * std::numbers::sqrt2 + gap, 0},
                           Eigen::AngleAxisd(std::numbers::pi / 4, Vector3d::UnitX()).matrix())) {}
};

TEST(SurfacePairs, OnlyEdgesSeeCrossedCubes) {
  for (const double gap : {0.1, 1e-3, 1e-14, 0.0, -1e-3, -0.1, -0.4}) {
    const CrossedCubes cubes(gap);
    const ContactSurface lower = surface_of(cubes.lower.V, cubes.lower.F),
                         upper = surface_of(cubes.upper.V, cubes.upper.F);
    const SurfaceState a(upper), b(lower);
    const std::vector<SurfacePair> pairs = near_pairs(a, b, 0.15);
    expect_sound(a, b, pairs, 0.15);
    ASSERT_EQ(pairs.size(), 1u) << gap;
    EXPECT_EQ(pairs[0].kind, SurfacePair::edge_edge);
    EXPECT_NEAR(pairs[0].distance, gap, 1e-12);
    EXPECT_LE((pairs[0].normal - Vector3d::UnitY()).norm(), 1e-9);
    EXPECT_NEAR(pairs[0].weight_a[0], 0.5, 1e-12);
    EXPECT_NEAR(pairs[0].weight_b[0], 0.5, 1e-12);
  }
}

TEST(SurfacePairs, FlatContactIsThatOfTheCornersOfTheCommonFace) {
  const Shape lower = cube(), upper = cube().moved({0.3, 2.001, 0.2});
  const ContactSurface surface_a = surface_of(upper.V, upper.F), surface_b = surface_of(lower.V, lower.F);
  const SurfaceState a(surface_a), b(surface_b);
  const std::vector<SurfacePair> pairs = near_pairs(a, b, 0.01);
  expect_sound(a, b, pairs, 0.01);
  EXPECT_EQ(of_kind(pairs, SurfacePair::point_face).size(), 1u);
  EXPECT_EQ(of_kind(pairs, SurfacePair::face_point).size(), 1u);
  EXPECT_EQ(of_kind(pairs, SurfacePair::edge_edge).size(), 2u);
  for (const SurfacePair& pair : pairs) {
    EXPECT_NEAR(pair.distance, 0.001, 1e-12);
    EXPECT_LE((pair.normal - Vector3d::UnitY()).norm(), 1e-9);
  }
}

// Planks that lie crosswise touch in four places, where no corner is, also when the upper one tilts a little.
TEST(SurfacePairs, CrossedPlanksTouchInFourPlaces) {
  Shape plank = cube();
  plank.V.col(0) *= 5;
  const Shape across =
      plank.moved(Vector3d::Zero(), Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitY()).matrix());
  const ContactSurface surface_b = surface_of(plank.V, plank.F);
  const SurfaceState b(surface_b);
  for (const double tilt : {0.0, 1e-9, 1e-3, 0.02}) {
    for (const double gap : {0.03, -0.03}) {
      const Shape upper =
          across.moved({0, 2 + gap, 0}, Eigen::AngleAxisd(tilt, Vector3d(1, 0, 1).normalized()).matrix());
      const ContactSurface surface_a = surface_of(upper.V, upper.F);
      const SurfaceState a(surface_a);
      const std::vector<SurfacePair> pairs = near_pairs(a, b, 0.1);
      expect_sound(a, b, pairs, 0.1);
      EXPECT_EQ(pairs.size(), 4u) << tilt << " " << gap;
      for (const SurfacePair& pair : pairs) {
        EXPECT_EQ(pair.kind, SurfacePair::edge_edge);
        EXPECT_NEAR(pair.distance, gap, 1.5 * tilt + 1e-12);
        EXPECT_GT(pair.normal.y(), 0.999);
      }
    }
  }
}

TEST(SurfacePairs, AShellIsTouchedFromBothSides) {
  const Shape plate = sheet(4, 4, 0.25);
  const ContactSurface shell = surface_of(plate.V, plate.F, 0.01);
  const SurfaceState b(shell);
  for (const double side : {1.0, -1.0}) {
    const Shape ball = sphere(1).moved({0.5, side * 1.05, 0.5});
    const ContactSurface solid = surface_of(ball.V, ball.F);
    const SurfaceState a(solid);
    const std::vector<SurfacePair> pairs = near_pairs(a, b, 0.3);
    expect_sound(a, b, pairs, 0.3);
    ASSERT_FALSE(pairs.empty());
    for (const SurfacePair& pair : of_kind(pairs, SurfacePair::point_face)) {
      EXPECT_GT(pair.distance, 0);
      EXPECT_GT(side * pair.normal.y(), 0.9);
    }
  }
}

TEST(SurfacePairs, RimsOfTwoShellsThatCross) {
  // A plate on edge above the rim of another, at a right angle to it.
  const Shape flat = sheet(2, 2, 0.5);
  const Shape upright = sheet(2, 2, 0.5).moved(
      {1.02, 0.4, 0.3}, Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d(0, 0, 1)).matrix());
  const ContactSurface surface_a = surface_of(upright.V, upright.F, 0.01),
                       surface_b = surface_of(flat.V, flat.F, 0.01);
  SurfaceState a(surface_a);
  const SurfaceState b(surface_b);
  // Its lower edge runs along z, as the rim at x = 1: turned about y, the rims cross.
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitY()).matrix();
  const Shape crossing = Shape{upright.V.rowwise() - Eigen::RowVector3d(1.02, 0.4, 0.3), upright.F}.moved(
      {0.6, 0.03, 0.7}, turn);
  a.move_to(flat_points(crossing.V));
  const std::vector<SurfacePair> pairs = near_pairs(a, b, 0.05);
  expect_sound(a, b, pairs, 0.05);
  for (const SurfacePair& pair : pairs) {
    EXPECT_NEAR(pair.distance, 0.03, 1e-12);
    EXPECT_LE((pair.normal - Vector3d::UnitY()).norm(), 1e-12);
  }
  EXPECT_FALSE(of_kind(pairs, SurfacePair::edge_edge).empty());
}

TEST(SurfacePairs, SolidsOfThePlane) {
  Points2 square(4, 2), corner(3, 2);
  square << 0, 0, 1, 0, 1, 1, 0, 1;
  corner << 0.5, 0.9, 0.8, 1.5, 0.2, 1.5;
  const ContactSurface surface_a = planar_surface(corner, true), surface_b = planar_surface(square, true);
  const SurfaceState a(surface_a), b(surface_b);
  const std::vector<SurfacePair> pairs = near_pairs(a, b, 0.01);
  expect_sound(a, b, pairs, 0.01);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].kind, SurfacePair::point_face);
  EXPECT_NEAR(pairs[0].distance, -0.1, 1e-15);
  EXPECT_EQ(pairs[0].normal, Vector3d(0, 1, 0));
  EXPECT_EQ(pairs[0].b, (std::array{2, 3, -1}));
  EXPECT_NEAR(pairs[0].weight_b[0], 0.5, 1e-15);
  // Signs everywhere, corners included.
  CounterRng rng(8);
  for (int trial = 0; trial < 1000; ++trial) {
    const Vector3d y(rng.uniform(-0.5, 1.5), rng.uniform(-0.5, 1.5), 0);
    const Vector3d beyond = (-y).cwiseMax(y - Vector3d(1, 1, 0));
    const double expected =
        std::max(beyond.x(), beyond.y()) < 0 ? std::max(beyond.x(), beyond.y()) : beyond.cwiseMax(0).norm();
    EXPECT_NEAR(b.nearest(y, INFINITY)->distance, expected, 1e-14);
  }
}

TEST(SurfacePairs, RodsOfThePlane) {
  Points2 line(3, 2), post(2, 2);
  line << -1, 0, 0, 0, 1, 0;
  const ContactSurface surface_b = planar_surface(line, false, 0.01);
  const SurfaceState b(surface_b);
  for (const double side : {1.0, -1.0}) {
    post << 0.3, side * 0.02, 0.3, side;
    const ContactSurface surface_a = planar_surface(post, false, 0.01);
    const SurfaceState a(surface_a);
    const std::vector<SurfacePair> pairs = near_pairs(a, b, 0.05);
    expect_sound(a, b, pairs, 0.05);
    ASSERT_EQ(pairs.size(), 1u);
    EXPECT_EQ(pairs[0].kind, SurfacePair::point_face);
    EXPECT_NEAR(pairs[0].distance, 0.02, 1e-15);
    EXPECT_NEAR(pairs[0].normal.y(), side, 1e-15);
  }
}

TEST(SurfacePairs, AtDistanceZeroHaveNormals) {
  const Shape shape = cube();
  for (const double radius : {0.0, 0.1}) {
    const ContactSurface surface = surface_of(shape.V, shape.F, radius);
    const SurfaceState a(surface), b(surface);  // the same place: every point on its own copy
    const std::vector<SurfacePair> pairs = near_pairs(a, b, 0.1);
    ASSERT_GE(pairs.size(), 16u);
    expect_sound(a, b, pairs, 0.1);
    for (const SurfacePair& pair : pairs) EXPECT_EQ(pair.distance, 0);
  }
  // A point without any face around it, faces without area, edges without length.
  Shape dot{Points::Zero(3, 3), RowMatrixXi(1, 3)};
  dot.F << 0, 1, 2;
  const ContactSurface nothing = surface_of(dot.V, dot.F), solid = surface_of(shape.V, shape.F);
  expect_sound(SurfaceState(nothing), SurfaceState(nothing),
               near_pairs(SurfaceState(nothing), SurfaceState(nothing), 1), 1);
  expect_sound(SurfaceState(nothing), SurfaceState(solid),
               near_pairs(SurfaceState(nothing), SurfaceState(solid), 2), 2);
}

TEST(SurfacePairs, FollowTheVerticesThatCarryThePoints) {
  // Points in the middles of the edges of two vertices each.
  const Shape shape = bumpy_sphere(1, 0.9, 1.1, 4);
  ContactSurface carried = surface_of(shape.V, shape.F);
  const auto count = static_cast<int>(shape.V.rows());
  carried.points.vertices.resize(count, 2);
  carried.points.weights.setConstant(count, 2, 0.5);
  for (int i = 0; i < count; ++i) carried.points.vertices.row(i) << 2 * i, 2 * i + 1;
  Eigen::VectorXd x(6 * count);
  const Shape moved = shape.moved({1.5, 0.2, -0.1});
  for (int i = 0; i < count; ++i) {
    x.segment<3>(6 * i) = moved.V.row(i).transpose() + Vector3d(0.1, 0.2, 0.3);
    x.segment<3>(6 * i + 3) = moved.V.row(i).transpose() - Vector3d(0.1, 0.2, 0.3);
  }
  SurfaceState state(carried);
  state.move_to(x);
  EXPECT_LE((state.points() - moved.V).norm(), 1e-12);
  const ContactSurface still = surface_of(moved.V, moved.F), other_surface = surface_of(shape.V, shape.F);
  const SurfaceState expected(still), other(other_surface);
  const auto pairs = near_pairs(state, other, 0.3), same = near_pairs(expected, other, 0.3);
  ASSERT_EQ(pairs.size(), same.size());
  ASSERT_GT(pairs.size(), 10u);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    EXPECT_EQ(std::tie(pairs[k].kind, pairs[k].feature_a, pairs[k].feature_b),
              std::tie(same[k].kind, same[k].feature_a, same[k].feature_b));
    EXPECT_NEAR(pairs[k].distance, same[k].distance, 1e-12);
  }
  EXPECT_TRUE(boxes_near(state, other, 0));
}

TEST(SurfacePairs, RefusesAFaceWhoseEdgesAreNotListed) {
  const Shape shape = cube();
  ContactSurface surface = surface_of(shape.V, shape.F);
  surface.edges.conservativeResize(5, 2);
  EXPECT_THROW(SurfaceState{surface}, Error);
}

// A strip of 20 squares of 5 cm, folded in its middle about a half circle of 2 cm radius.
Shape folded(const Shape& strip, double radius) {
  Shape shape = strip;
  const double length = strip.V.col(0).maxCoeff(), arc = std::numbers::pi * radius,
               start = (length - arc) / 2;
  for (Eigen::Index i = 0; i < strip.V.rows(); ++i) {
    const double s = strip.V(i, 0) - start;
    if (s <= 0) continue;
    const double angle = std::min(s, arc) / radius, rest = std::max(s - arc, 0.0);
    shape.V(i, 0) = start + radius * std::sin(angle) - rest;
    shape.V(i, 1) = radius * (1 - std::cos(angle));
  }
  return shape;
}

TEST(SelfPairs, OfAFoldedStripJoinItsTwoHalves) {
  const Shape strip = sheet(20, 3, 0.05), fold = folded(strip, 0.02);
  const ContactSurface surface = surface_of(strip.V, strip.F, 0.005);
  SurfaceState state(surface);
  EXPECT_TRUE(near_self_pairs(state, 0.06).empty());  // flat
  state.move_to(flat_points(fold.V));
  const std::vector<SurfacePair> pairs = near_self_pairs(state, 0.045);
  expect_sound(state, state, pairs, 0.045);
  std::set<int> points;
  for (const SurfacePair& pair : pairs) {
    EXPECT_GE(pair.distance, 0.03);
    if (pair.kind == SurfacePair::point_face) points.insert(pair.feature_a);
    // The two places belong to different halves.
    const double s_a = place_of(SurfaceState(surface), pair.a, pair.weight_a).x();
    const double s_b = place_of(SurfaceState(surface), pair.b, pair.weight_b).x();
    EXPECT_LT(std::min(s_a, s_b), 0.5);
    EXPECT_GT(std::max(s_a, s_b), 0.5);
  }
  EXPECT_GT(points.size(), 60u);  // of 84
}

TEST(SelfPairs, OfAStripCrossedByItsOtherEndJoinItsEdges) {
  const Shape strip = sheet(20, 1, 0.05);
  Shape crossed = strip;  // the half beyond s = 0.5 lies 3 cm above the other, at a right angle to it
  for (Eigen::Index i = 0; i < strip.V.rows(); ++i) {
    const double s = strip.V(i, 0), z = strip.V(i, 2);
    if (s > 0.5) crossed.V.row(i) << 0.253 + z, 0.03, 0.013 + (s - 0.75);
  }
  const ContactSurface surface = surface_of(strip.V, strip.F, 0.005);
  SurfaceState state(surface);
  state.move_to(flat_points(crossed.V));
  const std::vector<SurfacePair> pairs = near_self_pairs(state, 0.04);
  expect_sound(state, state, pairs, 0.04);
  // Shells have no cones of normals: every two edges that cross in the view along the normal are a pair.
  int crossing = 0, expected = 0;
  for (const SurfacePair& pair : of_kind(pairs, SurfacePair::edge_edge)) {
    crossing += std::abs(pair.distance - 0.03) < 1e-12 && std::abs(pair.normal.y()) > 1 - 1e-12;
  }
  const auto cross2 = [&](int o, int p, int q) {
    const Eigen::RowVector3d u = crossed.V.row(p) - crossed.V.row(o), v = crossed.V.row(q) - crossed.V.row(o);
    return u.x() * v.z() - u.z() * v.x();
  };
  for (Eigen::Index i = 0; i < surface.edges.rows(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      const int a = surface.edges(i, 0), b = surface.edges(i, 1), c = surface.edges(j, 0),
                d = surface.edges(j, 1);
      const auto high = [&](int v) { return crossed.V(v, 1) > 0.029; };
      if (high(a) != high(b) || high(c) != high(d) || high(a) == high(c)) continue;
      expected += cross2(a, b, c) * cross2(a, b, d) < 0 && cross2(c, d, a) * cross2(c, d, b) < 0;
    }
  }
  EXPECT_GT(crossing, 4);
  EXPECT_EQ(crossing, expected);
}

TEST(SelfPairs, OfARodOfThePlane) {
  const int count = 41;
  Points2 straight(count, 2);
  for (int i = 0; i < count; ++i) straight.row(i) << 0.025 * i, 0;
  const ContactSurface surface = planar_surface(straight, false, 0.005);
  SurfaceState state(surface);
  EXPECT_TRUE(near_self_pairs(state, 0.045).empty());
  Shape line{Points::Zero(count, 3), RowMatrixXi(0, 3)};
  line.V.col(0) = straight.col(0);
  const Shape fold = folded(line, 0.02);
  state.move_to(Points2(fold.V.leftCols(2)).reshaped<Eigen::RowMajor>());
  const std::vector<SurfacePair> pairs = near_self_pairs(state, 0.045);
  expect_sound(state, state, pairs, 0.045);
  EXPECT_GT(pairs.size(), 30u);
  for (const SurfacePair& pair : pairs) EXPECT_NEAR(pair.distance, 0.04, 0.002);
}

// A solid C: its jaws touch, but the two sides of a squashed arm do not.
TEST(SelfPairs, OfASolidJoinSidesThatFaceEachOther) {
  const Shape strip = sheet(20, 3, 0.05);
  // Thicken the strip: its points at y = 0 and y = 0.04, closed along the rim.
  const auto n = static_cast<int>(strip.V.rows()), m = static_cast<int>(strip.F.rows());
  Shape bar{Points(2 * n, 3), RowMatrixXi(2 * m, 3)};
  bar.V << strip.V, strip.V;
  bar.V.bottomRows(n).col(1).array() += 0.04;
  std::map<std::pair<int, int>, int> open;
  for (int f = 0; f < m; ++f) {
    const int a = strip.F(f, 0), b = strip.F(f, 1), c = strip.F(f, 2);
    bar.F.row(f) << a, c, b;
    bar.F.row(m + f) << n + a, n + b, n + c;
    for (const auto& [u, v] : {std::pair(a, b), {b, c}, {c, a}}) {
      if (!open.erase({v, u})) open[{u, v}] = 1;
    }
  }
  const auto walls = static_cast<int>(open.size());
  bar.F.conservativeResize(2 * m + 2 * walls, 3);
  int row = 2 * m;
  for (const auto& [edge, unused] : open) {
    const auto [u, v] = edge;
    bar.F.row(row++) << u, v, n + u;
    bar.F.row(row++) << v, n + v, n + u;
  }
  const ContactSurface surface = surface_of(bar.V, bar.F);
  ASSERT_GT(signed_volume({surface.rest, Triangles(surface.faces), {}, {}, {}}), 0);
  SurfaceState state(surface);
  EXPECT_TRUE(near_self_pairs(state, 0.015).empty());
  Shape squashed = bar;
  squashed.V.col(1) *= 0.3;  // 12 mm thick, its sides within the reach of each other
  state.move_to(flat_points(squashed.V));
  EXPECT_TRUE(near_self_pairs(state, 0.015).empty());
  // Folded upwards: inner sides 1 cm apart.
  Shape fold = folded(bar, 0.045);
  for (Eigen::Index i = 0; i < bar.V.rows(); ++i) {
    // Keep the height above the folded middle plane: along the normal of the fold.
    Shape at{Points(1, 3), RowMatrixXi(0, 3)};
    const double length = bar.V.col(0).maxCoeff(), arc = std::numbers::pi * 0.045, start = (length - arc) / 2;
    const double angle = std::clamp((bar.V(i, 0) - start) / 0.045, 0.0, std::numbers::pi);
    const Vector3d base(fold.V(i, 0), bar.V(i, 0) <= start ? 0.0 : fold.V(i, 1), fold.V(i, 2));
    const Vector3d up(-std::sin(angle), std::cos(angle), 0);
    fold.V.row(i) = (base + bar.V(i, 1) * up).transpose();
  }
  state.move_to(flat_points(fold.V));
  const std::vector<SurfacePair> pairs = near_self_pairs(state, 0.015);
  expect_sound(state, state, pairs, 0.015);
  ASSERT_GT(pairs.size(), 40u);
  for (const SurfacePair& pair : pairs) {
    EXPECT_GT(pair.distance, 0);
    EXPECT_GT(std::min(pair.a[0], pair.b[0]), n - 1);  // upper sides, now inner ones
  }
}

}  // namespace
}  // namespace vivify::sim
