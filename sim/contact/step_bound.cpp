#include "sim/contact/step_bound.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/contact/closest_points.h"

namespace vivify::sim {
namespace {

using Eigen::Vector3d;

constexpr double kTouching = 1e-12;  // m
constexpr double kSlack = 0.01;      // of the distance at the start: near enough to the bound
constexpr double kMargin = 1e-3;     // of the mean edge: of the boxes of motions, against rounding
constexpr int kMostAdvances = 10000;

// A surface that moves: its points and how far they go until t = 1.
struct Motion {
  const SurfaceState& state;
  Points move;           // #P by 3
  BoxTree sides, edges;  // of the whole motion

  Motion(const SurfaceState& at, const Eigen::VectorXd& dx)
      : state(at), move(at.points().rows(), 3), sides(at.side_tree()), edges(at.edge_tree()) {
    for (int i = 0; i < move.rows(); ++i) move.row(i) = at.surface().points.position(i, dx).transpose();
  }
  void refit() {
    const Points end = state.points() + move;
    sides.refit(state.sides(), state.points(), end);
    edges.refit(state.surface().edges, state.points(), end);
  }
  Vector3d point(int i, double t) const { return (state.points().row(i) + t * move.row(i)).transpose(); }
  double margin() const { return kMargin * state.mean_edge(); }
  BoundingBox box(int i, double around) const {
    BoundingBox box(point(i, 0));
    box.extend(point(i, 1));
    box.min().array() -= around;
    box.max().array() += around;
    return box;
  }
};

// Points that move as one do not come nearer: the speed of approach is at most the sum of the largest speeds
// of the two features about the mean of all.
template <std::size_t A, std::size_t B>
double approach_speed(const std::array<Vector3d, A>& a, const std::array<Vector3d, B>& b) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& v : a) mean += v / static_cast<double>(A + B);
  for (const Vector3d& v : b) mean += v / static_cast<double>(A + B);
  double fastest_a = 0, fastest_b = 0;
  for (const Vector3d& v : a) fastest_a = std::max(fastest_a, (v - mean).norm());
  for (const Vector3d& v : b) fastest_b = std::max(fastest_b, (v - mean).norm());
  return fastest_a + fastest_b;
}

// The largest t ≤ limit at which a distance (of t) that falls at most with `speed` is above share ·
// distance(0).
template <class Distance>
double advance(const Distance& distance, double speed, double share, double limit) {
  const double start = distance(0);
  if (!(start > kTouching)) return limit;
  const double least = share * start;
  double t = 0, d = start;
  for (int i = 0; i < kMostAdvances && d - least > kSlack * start; ++i) {
    if (d - least >= (limit - t) * speed) return limit;
    t += (d - least) / speed;
    d = distance(t);
  }
  return t;
}

double bound_of_point(const Motion& a, int p, const Motion& b, int side, double share, double limit) {
  const RowMatrixXi& S = b.state.sides();
  const int i = S(side, 0), j = S(side, 1);
  const auto v = [](const Motion& m, int point) -> Vector3d { return m.move.row(point).transpose(); };
  if (b.state.surface().planar()) {
    const double speed = approach_speed(std::array{v(a, p)}, std::array{v(b, i), v(b, j)});
    return advance(
        [&](double t) {
          const Vector3d y = a.point(p, t);
          return (nearest_on_segment(y, b.point(i, t), b.point(j, t)).position - y).norm();
        },
        speed, share, limit);
  }
  const int k = S(side, 2);
  const double speed = approach_speed(std::array{v(a, p)}, std::array{v(b, i), v(b, j), v(b, k)});
  return advance(
      [&](double t) {
        const Vector3d y = a.point(p, t);
        return (nearest_on_triangle(y, b.point(i, t), b.point(j, t), b.point(k, t)).position - y).norm();
      },
      speed, share, limit);
}

double bound_of_edges(const Motion& a, int i, const Motion& b, int j, double share, double limit) {
  const RowMatrixXi &E_a = a.state.surface().edges, &E_b = b.state.surface().edges;
  const int p = E_a(i, 0), q = E_a(i, 1), r = E_b(j, 0), s = E_b(j, 1);
  const auto v = [](const Motion& m, int point) -> Vector3d { return m.move.row(point).transpose(); };
  const double speed = approach_speed(std::array{v(a, p), v(a, q)}, std::array{v(b, r), v(b, s)});
  return advance(
      [&](double t) {
        return nearest_on_segments(a.point(p, t), a.point(q, t), b.point(r, t), b.point(s, t)).offset.norm();
      },
      speed, share, limit);
}

// Whether the edges of solids have crossed: each lies beyond the other, seen from outside.
bool have_crossed(const SurfaceState& a, int i, const SurfaceState& b, int j) {
  if (a.surface().two_sided && b.surface().two_sided) return false;
  const RowMatrixXi &E_a = a.surface().edges, &E_b = b.surface().edges;
  const Vector3d inwards = unit_or(
      nearest_on_segments(a.point(E_a(i, 0)), a.point(E_a(i, 1)), b.point(E_b(j, 0)), b.point(E_b(j, 1)))
          .offset,
      Vector3d::Zero());
  return b.edge_cone_has(j, -inwards) && a.edge_cone_has(i, inwards);
}

// The points that are inside the other body.
std::vector<bool> inside(const SurfaceState& points, const SurfaceState& body) {
  std::vector<bool> is_inside(static_cast<std::size_t>(points.points().rows()), false);
  if (body.surface().two_sided) return is_inside;
  const BoundingBox box = body.box();
  for (int p = 0; p < points.points().rows(); ++p) {
    if (!box.contains(points.point(p))) continue;
    const std::optional<SurfacePlace> place = body.nearest(points.point(p), INFINITY);
    is_inside[p] = place && place->distance < 0;
  }
  return is_inside;
}

void bound_points(const Motion& a, const std::vector<bool>& inside_b, const Motion& b, double share,
                  double& t) {
  const double margin = std::min(a.margin(), b.margin());
  for (int p = 0; p < a.move.rows(); ++p) {
    if (inside_b[p]) continue;
    b.sides.visit_near(a.box(p, margin), [&](int side) { t = bound_of_point(a, p, b, side, share, t); });
  }
}

}  // namespace

double step_bound(const SurfaceState& a, const Eigen::VectorXd& dx_a, const SurfaceState& b,
                  const Eigen::VectorXd& dx_b, double share) {
  Motion motion_a(a, dx_a), motion_b(b, dx_b);
  // Only the motion of one relative to the other matters.
  if (motion_b.move.rows() == 0) return 1;
  const Eigen::RowVector3d mean = motion_b.move.colwise().mean();
  motion_a.move.rowwise() -= mean;
  motion_b.move.rowwise() -= mean;
  motion_a.refit();
  motion_b.refit();
  const double margin = std::min(motion_a.margin(), motion_b.margin());
  if (box_distance2(motion_a.sides.box(), motion_b.sides.box()) > margin * margin) return 1;
  const std::vector<bool> a_inside = inside(a, b), b_inside = inside(b, a);
  double t = 1;
  bound_points(motion_a, a_inside, motion_b, share, t);
  bound_points(motion_b, b_inside, motion_a, share, t);
  BoxTree::visit_pairs(motion_a.edges, motion_b.edges, margin, [&](int i, int j) {
    const auto is_in = [](const std::vector<bool>& points, const RowMatrixXi& edges, int e) {
      return points[edges(e, 0)] || points[edges(e, 1)];
    };
    if (is_in(a_inside, a.surface().edges, i) || is_in(b_inside, b.surface().edges, j)) return;
    const double bound = bound_of_edges(motion_a, i, motion_b, j, share, t);
    if (bound < t && !have_crossed(a, i, b, j)) t = bound;
  });
  return t;
}

double self_step_bound(const SurfaceState& a, const Eigen::VectorXd& dx, double share) {
  Motion motion(a, dx);
  if (motion.move.rows() == 0) return 1;
  motion.move.rowwise() -= Eigen::RowVector3d(motion.move.colwise().mean());
  motion.refit();
  const bool solid = !a.surface().two_sided;
  const RowMatrixXi &S = a.sides(), &E = a.surface().edges;
  double t = 1;
  for (int p = 0; p < motion.move.rows(); ++p) {
    motion.sides.visit_near(motion.box(p, motion.margin()), [&](int side) {
      if ((S.row(side).array() == p).any()) return;
      // Material lies between the point of a solid and the sides that it is behind.
      if (solid && a.side_normal(side).dot(a.point(p) - a.point(S(side, 0))) < 0) return;
      t = bound_of_point(motion, p, motion, side, share, t);
    });
  }
  BoxTree::visit_pairs(motion.edges, motion.edges, motion.margin(), [&](int i, int j) {
    if (i >= j || E(i, 0) == E(j, 0) || E(i, 0) == E(j, 1) || E(i, 1) == E(j, 0) || E(i, 1) == E(j, 1))
      return;
    const double bound = bound_of_edges(motion, i, motion, j, share, t);
    if (bound < t && !have_crossed(a, i, a, j)) t = bound;
  });
  return t;
}

}  // namespace vivify::sim
