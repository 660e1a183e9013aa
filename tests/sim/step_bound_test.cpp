// The bound on a motion against finely sampled motions.
#include "sim/contact/step_bound.h"

#include <gtest/gtest.h>

#include <numbers>

#include "sim/contact/closest_points.h"
#include "tests/sim/contact_shapes.h"

namespace vivify::sim {
namespace {

using Eigen::Vector3d;

// Distances of all points and faces and of all edges of two surfaces.
std::vector<double> distances(const Shape& a, const Shape& b) {
  const auto point = [](const Shape& shape, int i) -> Vector3d { return shape.V.row(i).transpose(); };
  std::vector<double> all;
  for (const bool of_a : {true, false}) {
    const Shape &points = of_a ? a : b, &faces = of_a ? b : a;
    for (int p = 0; p < points.V.rows(); ++p) {
      for (Eigen::Index f = 0; f < faces.F.rows(); ++f) {
        const TrianglePlace place =
            nearest_on_triangle(point(points, p), point(faces, faces.F(f, 0)), point(faces, faces.F(f, 1)),
                                point(faces, faces.F(f, 2)));
        all.push_back((place.position - point(points, p)).norm());
      }
    }
  }
  const RowMatrixXi E_a = edges_of(a.F), E_b = edges_of(b.F);
  for (Eigen::Index i = 0; i < E_a.rows(); ++i) {
    for (Eigen::Index j = 0; j < E_b.rows(); ++j) {
      all.push_back(nearest_on_segments(point(a, E_a(i, 0)), point(a, E_a(i, 1)), point(b, E_b(j, 0)),
                                        point(b, E_b(j, 1)))
                        .offset.norm());
    }
  }
  return all;
}

Shape after(const Shape& shape, const Points& move, double t) { return {shape.V + t * move, shape.F}; }

Points random_moves(Eigen::Index count, double size, CounterRng& rng) {
  Points moves(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) moves.row(i) = random_point(size, rng).transpose();
  return moves;
}

// Smallest ratio of the distances at t to those at the start.
double least_share(const Shape& a, const Points& move_a, const Shape& b, const Points& move_b, double t) {
  const std::vector<double> start = distances(a, b),
                            now = distances(after(a, move_a, t), after(b, move_b, t));
  double least = INFINITY;
  for (std::size_t k = 0; k < start.size(); ++k) least = std::min(least, now[k] / start[k]);
  return least;
}

// Whether an edge of one triangle passes through the other.
bool intersect(const Shape& a, const Shape& b) {
  for (const auto& [edges, face] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    Eigen::Matrix3d T = face->V.transpose();
    for (int k = 0; k < 3; ++k) {
      const Vector3d p = edges->V.row(k).transpose(), q = edges->V.row((k + 1) % 3).transpose();
      Eigen::Matrix3d M;  // p + s (q − p) = a + u (b − a) + v (c − a)
      M << T.col(1) - T.col(0), T.col(2) - T.col(0), p - q;
      const Vector3d uvs = M.inverse() * (p - T.col(0));
      if (uvs.minCoeff() > 0 && uvs[0] + uvs[1] < 1 && uvs[2] < 1) return true;
    }
  }
  return false;
}

double bound(const Shape& a, const Points& move_a, const Shape& b, const Points& move_b, double share = 0.1,
             double radius = 0.01) {
  const ContactSurface surface_a = surface_of(a.V, a.F, radius), surface_b = surface_of(b.V, b.F, radius);
  return step_bound(SurfaceState(surface_a), flat_points(move_a), SurfaceState(surface_b),
                    flat_points(move_b), share);
}

Points uniform(const Shape& shape, const Vector3d& move) {
  return move.transpose().replicate(shape.V.rows(), 1);
}

Shape random_triangle(CounterRng& rng) {
  Shape shape{random_moves(3, 0.5, rng), RowMatrixXi(1, 3)};
  shape.F << 0, 1, 2;
  return shape.moved(random_point(1, rng));
}

TEST(StepBound, OfFastTrianglesNeverMissesAndIsTight) {
  CounterRng rng(1);
  int held = 0, crossings = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const Shape a = random_triangle(rng), b = random_triangle(rng);
    const double speed = rng.uniform(0.1, 5), share = trial % 2 ? 0.1 : 0.5;
    const Points move_a = random_moves(3, speed, rng), move_b = random_moves(3, speed, rng);
    const double t = bound(a, move_a, b, move_b, share);
    ASSERT_GT(t, 0);
    ASSERT_LE(t, 1);
    // Triangles that are apart at first stay so until t, however fast they would cross later.
    if (intersect(a, b)) continue;
    int first = 0;  // sample at which they intersect
    for (int sample = 1; sample <= 300 && first == 0; ++sample) {
      if (intersect(after(a, move_a, sample / 300.0), after(b, move_b, sample / 300.0))) first = sample;
    }
    if (first > 0) {
      ++crossings;
      EXPECT_LT(t, first / 300.0) << trial;
    }
    if (t == 1) continue;
    ++held;
    EXPECT_LE(least_share(a, move_a, b, move_b, t), share + 0.0101) << trial;
  }
  EXPECT_GT(held, 200);
  EXPECT_GT(crossings, 100);
}

TEST(StepBound, OfTwoBallsThatMeet) {
  const Shape ball = sphere(1), other = sphere(1).moved({3, 0.2, 0.1});
  CounterRng rng(2);
  Points move = uniform(ball, {7, 0, 0});  // would come out on the other side
  move += random_moves(ball.V.rows(), 0.1, rng);
  const Points none = uniform(other, Vector3d::Zero());
  const double t = bound(ball, move, other, none, 0.1, 0);
  EXPECT_LT(t, 0.2);
  EXPECT_GE(least_share(ball, move, other, none, t), 0.1 - 1e-9);
  EXPECT_LE(least_share(ball, move, other, none, t), 0.1101);
  // The same motion on top of any common one.
  const Points common = uniform(ball, {-3, 100, 20});
  EXPECT_NEAR(bound(ball, move + common, other, none + common, 0.1, 0), t, 1e-12);
  EXPECT_NEAR(bound(other, none, ball, move, 0.1, 0), t, 0.02);
}

TEST(StepBound, GrazingMotionIsFree) {
  const Shape plate = sheet(3, 3, 0.3), card = sheet(2, 2, 0.1).moved({-0.5, 1e-3, 0.3});
  EXPECT_EQ(bound(card, uniform(card, {2, 0, 0}), plate, uniform(plate, {0, 0, 0})), 1);
  EXPECT_EQ(bound(card, uniform(card, {0, 5, 0}), plate, uniform(plate, {0, 0, 0})), 1);
  EXPECT_EQ(bound(card, uniform(card, {40, -50, 3}), plate, uniform(plate, {40, -50, 3})), 1);
}

TEST(StepBound, OfParallelEdges) {
  Shape card{Points(3, 3), RowMatrixXi(1, 3)};
  card.V << 0, 0.2, 0, 1, 0.2, 0, 0.5, 1, 0;
  card.F << 0, 1, 2;
  for (const double shift : {0.0, 0.3, -0.7}) {
    const Shape other =
        card.moved({shift, -0.2, 0}, Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitX()).matrix());
    // The lower edge of the card is 0.8 above the upper edge of the other, and falls by 1.2.
    const double t =
        bound(card.moved({0, 0.2, 0}), uniform(card, {0, -1.2, 0}), other, uniform(card, {0, 0, 0}));
    EXPECT_LE(t, 0.9 * 0.8 / 1.2 + 1e-12);
    EXPECT_GE(t, 0.88 * 0.8 / 1.2);
  }
}

TEST(StepBound, ACardDoesNotFallEdgeOnThroughAPlate) {
  const Shape plate = sheet(1, 1, 1);
  const Shape card = sheet(1, 1, 0.2).moved(
      {0.33, 0.25, 0.41}, Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitZ()).matrix());
  for (const double speed : {0.3, 10.0, 1000.0}) {
    const Points fall = uniform(card, {0, -speed, 0});
    const double t = bound(card, fall, plate, uniform(plate, {0, 0, 0}));
    const double gap = card.V.col(1).minCoeff();
    EXPECT_LE(t * speed, 0.9 * gap + 1e-12);
    EXPECT_GE(t * speed, 0.88 * gap);
  }
}

TEST(StepBound, WhatIsInsideMayLeave) {
  const Shape large = cube(), small{0.3 * cube().V, cube().F};
  const Shape within = small.moved({0.9, 0.1, 0.2});  // partly inside
  EXPECT_EQ(bound(within, uniform(within, {0.5, 0, 0}), large, uniform(large, {0, 0, 0}), 0.1, 0), 1);
  // Beside the face it is held as ever.
  const Shape beside = small.moved({1.5, 0.1, 0.2});
  const double t = bound(beside, uniform(beside, {-10, 0, 0}), large, uniform(large, {0, 0, 0}), 0.1, 0);
  EXPECT_NEAR(t, 0.9 * 0.2 / 10, 0.01 * 0.2 / 10 + 1e-12);
  EXPECT_LE(t, 0.9 * 0.2 / 10 + 1e-12);
}

TEST(StepBound, OfPointsAndEdgesOfThePlane) {
  Points2 line(3, 2), dart(2, 2);
  line << -1, 0, 0, 0, 1, 0.2;
  dart << 0.3, 0.4, 0.3, 1;
  const ContactSurface floor = planar_surface(line, false, 0.01), arrow = planar_surface(dart, false, 0.01);
  const Eigen::VectorXd still = Eigen::VectorXd::Zero(6);
  const double t =
      step_bound(SurfaceState(arrow), Eigen::Vector4d(0, -20, 0, -20), SurfaceState(floor), still);
  // Distances along the fall shrink in proportion until the nearest place turns to the corner.
  EXPECT_LE(20 * t, 0.9 * 0.34 + 1e-12);
  EXPECT_GE(20 * t, 0.88 * 0.34);
  EXPECT_EQ(step_bound(SurfaceState(arrow), Eigen::Vector4d(0, 3, 0, 3), SurfaceState(floor), still), 1);
}

TEST(StepBound, OfASheetThatFoldsOntoItself) {
  const Shape strip = sheet(12, 1, 0.05);
  // A V: the right half turned up; then it slams down through the left one.
  Shape open = strip;
  const double angle = 2.0;
  for (Eigen::Index i = 0; i < strip.V.rows(); ++i) {
    const double s = strip.V(i, 0) - 0.3;
    if (s > 0) open.V.row(i) << 0.3 + s * std::cos(angle), s * std::sin(angle), strip.V(i, 2);
  }
  Points slam = Points::Zero(strip.V.rows(), 3);
  for (Eigen::Index i = 0; i < strip.V.rows(); ++i) {
    if (strip.V(i, 0) > 0.31) slam(i, 1) = -3 * open.V(i, 1);
  }
  const ContactSurface surface = surface_of(strip.V, strip.F, 0.002);
  SurfaceState state(surface);
  state.move_to(flat_points(open.V));
  const double t = self_step_bound(state, flat_points(slam));
  EXPECT_GT(t, 0.2);
  EXPECT_LT(t, 1.0 / 3);
  EXPECT_EQ(self_step_bound(state, flat_points(uniform(open, {5, 7, -100}))), 1);
  EXPECT_EQ(self_step_bound(state, flat_points(Points(0.3 * open.V))), 1);  // grows
}

TEST(StepBound, OfASolidThatIsSquashedIsItsOwnAffair) {
  const Shape ball = sphere(1);
  const ContactSurface surface = surface_of(ball.V, ball.F);
  const SurfaceState state(surface);
  Points squash = Points::Zero(ball.V.rows(), 3);
  squash.col(1) = -0.5 * ball.V.col(1);
  EXPECT_EQ(self_step_bound(state, flat_points(squash)), 1);
}

}  // namespace
}  // namespace vivify::sim
