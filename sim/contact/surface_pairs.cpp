#include "sim/contact/surface_pairs.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "common/error.h"
#include "sim/contact/closest_points.h"

namespace vivify::sim {
namespace {

constexpr double kTouching = 1e-12;      // m; below, the offset of two places has no direction
constexpr double kKeptSlack = 0.2;       // kConeSlack of a contact that was there before
constexpr double kFlat = 0.05;           // sine of the angle by which faces turn at an edge that may touch
constexpr double kParallel2 = 1e-8;      // squared sine of the angle below which points describe two edges
constexpr double kCrossingDepth = 0.25;  // of the mean edge: how deep crossed edges are looked for
constexpr double kRestShare = 2;         // of the reach: features nearer than this at rest never touch
constexpr double kSquashed = 0.25;       // of the distance at rest: deeper is squashed material

const Eigen::Vector3d kAnyDirection = Eigen::Vector3d::UnitY();

std::array<int, 3> points_of(const RowMatrixXi& elements, int element) {
  std::array<int, 3> points = {-1, -1, -1};
  for (int k = 0; k < elements.cols(); ++k) points[k] = elements(element, k);
  return points;
}

bool share_points(const std::array<int, 3>& a, const std::array<int, 3>& b) {
  return std::any_of(a.begin(), a.end(),
                     [&](int i) { return i >= 0 && std::find(b.begin(), b.end(), i) != b.end(); });
}

}  // namespace

SurfaceState::Lists SurfaceState::lists_of(const RowMatrixXi& table, int count) {
  Lists lists;
  lists.first.assign(static_cast<std::size_t>(count) + 1, 0);
  for (const int item : table.reshaped()) ++lists.first[item + 1];
  for (int i = 0; i < count; ++i) lists.first[i + 1] += lists.first[i];
  lists.items.resize(static_cast<std::size_t>(table.size()));
  std::vector<int> next(lists.first.begin(), lists.first.end() - 1);
  for (Eigen::Index row = 0; row < table.rows(); ++row) {
    for (Eigen::Index k = 0; k < table.cols(); ++k)
      lists.items[next[table(row, k)]++] = static_cast<int>(row);
  }
  return lists;
}

SurfaceState::SurfaceState(const ContactSurface& surface) : surface_(&surface), points_(surface.rest) {
  const RowMatrixXi& edges = surface.edges;
  point_sides_ = lists_of(sides(), surface.points.size());
  for (Eigen::Index e = 0; e < edges.rows(); ++e) {
    mean_edge_ +=
        (points_.row(edges(e, 0)) - points_.row(edges(e, 1))).norm() / static_cast<double>(edges.rows());
  }
  side_tree_ = BoxTree(sides(), points_);
  if (surface.planar()) return;
  std::map<std::pair<int, int>, int> edge_of;
  for (int e = 0; e < edges.rows(); ++e) edge_of.emplace(std::minmax({edges(e, 0), edges(e, 1)}), e);
  side_edges_.resize(surface.faces.rows(), 3);
  for (Eigen::Index f = 0; f < surface.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const auto found = edge_of.find(std::minmax({surface.faces(f, k), surface.faces(f, (k + 1) % 3)}));
      if (found == edge_of.end())
        throw Error(ErrorKind::geometry, "a contact face has an edge that is not listed");
      side_edges_(f, k) = found->second;
    }
  }
  edge_sides_ = lists_of(side_edges_, static_cast<int>(edges.rows()));
  edge_tree_ = BoxTree(edges, points_);
}

void SurfaceState::move_to(const Eigen::VectorXd& x) {
  for (int i = 0; i < surface_->points.size(); ++i) {
    points_.row(i) = surface_->points.position(i, x).transpose();
  }
  side_tree_.refit(sides(), points_);
  if (!surface_->planar()) edge_tree_.refit(surface_->edges, points_);
}

Eigen::Vector3d SurfaceState::side_normal(int side) const {
  const Eigen::Vector3d a = point(sides()(side, 0)), ab = point(sides()(side, 1)) - a;
  const Eigen::Vector3d doubled =
      surface_->planar() ? Eigen::Vector3d(ab.y(), -ab.x(), 0) : ab.cross(point(sides()(side, 2)) - a);
  return unit_or(doubled, Eigen::Vector3d::Zero());
}

Eigen::Vector3d SurfaceState::point_normal(int p) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const int side : point_sides_[p]) {
    if (surface_->planar()) {
      sum += side_normal(side);
      continue;
    }
    int k = 0;
    while (sides()(side, k) != p) ++k;
    sum += side_normal(side) *
           corner_angle(point(p), point(sides()(side, (k + 1) % 3)), point(sides()(side, (k + 2) % 3)));
  }
  return unit_or(sum, Eigen::Vector3d::Zero());
}

bool SurfaceState::edge_cone_has(int edge, const Eigen::Vector3d& n, double slack) const {
  if (surface_->two_sided) return true;
  const int p = surface_->edges(edge, 0), q = surface_->edges(edge, 1);
  const Eigen::Vector3d along = unit_or(point(q) - point(p), Eigen::Vector3d::Zero());
  const std::span<const int> faces = edge_sides_[edge];
  Eigen::Vector3d normals = Eigen::Vector3d::Zero();
  double descent = 0;
  for (const int face : faces) {
    int k = 0;
    while (sides()(face, k) == p || sides()(face, k) == q) ++k;
    const Eigen::Vector3d side = point(sides()(face, k)) - point(p);
    const Eigen::Vector3d into = unit_or(side - along * along.dot(side), Eigen::Vector3d::Zero());
    if (n.dot(into) > slack) return false;
    descent -= n.dot(into);
    normals += side_normal(face);
  }
  const bool rim = faces.size() < 2;
  return (rim || descent >= kFlat + kConeSlack - slack) && n.dot(normals) > 0;
}

template <class Allow>
std::optional<SurfacePlace> SurfaceState::nearest_allowed(const Eigen::Vector3d& y, double reach,
                                                          const Allow& allow) const {
  const RowMatrixXi& S = sides();
  double best2 = reach * reach;
  int best_side = -1;
  TrianglePlace best{};
  side_tree_.visit_near(y, best2, [&](int side) {
    const Eigen::Vector3d a = point(S(side, 0)), b = point(S(side, 1));
    const TrianglePlace place =
        surface_->planar() ? nearest_on_segment(y, a, b) : nearest_on_triangle(y, a, b, point(S(side, 2)));
    const double distance2 = (place.position - y).squaredNorm();
    if (!(distance2 < best2 || (distance2 == best2 && (best_side < 0 || side < best_side)))) return;
    if (!allow(side)) return;
    best2 = distance2;
    best_side = side;
    best = place;
  });
  if (best_side < 0) return std::nullopt;

  // The pseudo-normal of the face, edge or point.
  Eigen::Vector3d pseudo_normal = side_normal(best_side);
  bool rim = false;
  const bool within = best.feature == (surface_->planar() ? 4 : 0);
  if (!within && best.feature >= 4) {
    const auto faces = edge_sides_[side_edges_(best_side, best.feature - 4)];
    pseudo_normal.setZero();
    for (const int face : faces) pseudo_normal += side_normal(face);
    rim = faces.size() == 1;
  } else if (!within) {
    const int corner = S(best_side, best.feature - 1);
    pseudo_normal = point_normal(corner);
    if (surface_->planar()) {
      rim = point_sides_[corner].size() == 1;
    } else {
      for (const int face : point_sides_[corner]) {
        for (int k = 0; k < 3; ++k) {
          rim = rim || ((S(face, k) == corner || S(face, (k + 1) % 3) == corner) &&
                        edge_sides_[side_edges_(face, k)].size() == 1);
        }
      }
    }
  }
  pseudo_normal = unit_or(pseudo_normal, kAnyDirection);
  const Eigen::Vector3d offset = y - best.position;
  const double length = offset.norm();
  const bool behind = offset.dot(pseudo_normal) < 0;
  SurfacePlace place{best_side, points_of(S, best_side), best.weights, pseudo_normal, length};
  const bool inside = behind && !rim && !surface_->two_sided;
  if (inside) place.distance = -length;
  if (!within && length > kTouching) {
    place.normal = (inside ? -1 : 1) / length * offset;
  } else if (surface_->two_sided && behind) {
    place.normal = -pseudo_normal;
  }
  return place;
}

std::optional<SurfacePlace> SurfaceState::nearest(const Eigen::Vector3d& y, double reach) const {
  return nearest_allowed(y, reach, [](int) { return true; });
}

namespace {

SurfacePair point_pair(int point, const SurfacePlace& place) {
  return {SurfacePair::point_face, point,        -1,
          {point, -1, -1},         place.points, {1, 0, 0},
          place.weights,           place.normal, place.distance};
}

SurfacePair mirrored(const SurfacePair& pair) {
  return {SurfacePair::face_point, pair.feature_b, pair.feature_a, pair.b,       pair.a,
          pair.weight_b,           pair.weight_a,  -pair.normal,   pair.distance};
}

// Nearest places of the points of a on b.
void add_point_pairs(const SurfaceState& a, const SurfaceState& b, double reach, bool mirror,
                     std::vector<SurfacePair>& pairs) {
  const BoundingBox box = b.box();
  if (box.isEmpty()) return;
  for (int p = 0; p < a.points().rows(); ++p) {
    const Eigen::Vector3d y = a.point(p);
    const double outside2 = box.squaredExteriorDistance(y);
    if (outside2 > reach * reach) continue;
    const bool may_be_deep = !b.surface().two_sided && outside2 == 0;
    const std::optional<SurfacePlace> place = b.nearest(y, may_be_deep ? INFINITY : reach);
    if (!place || place->distance > reach) continue;
    pairs.push_back(mirror ? mirrored(point_pair(p, *place)) : point_pair(p, *place));
  }
}

// The nearest places of two edges that are not parallel, if they are inside both: along their common normal.
std::optional<SurfacePair> edges_across(const SurfaceState& a, int i, const SurfaceState& b, int j,
                                        double reach) {
  const std::array<int, 3> ends_a = points_of(a.surface().edges, i), ends_b = points_of(b.surface().edges, j);
  const Eigen::Vector3d a0 = a.point(ends_a[0]), a1 = a.point(ends_a[1]);
  const Eigen::Vector3d b0 = b.point(ends_b[0]), b1 = b.point(ends_b[1]);
  const auto [s, t, offset] = nearest_on_segments(a0, a1, b0, b1);
  if (s <= 0 || s >= 1 || t <= 0 || t >= 1) return std::nullopt;
  const double length = offset.norm();
  if (length > reach) return std::nullopt;
  const Eigen::Vector3d u = a1 - a0, v = b1 - b0, across = u.cross(v);
  if (across.squaredNorm() <= kParallel2 * u.squaredNorm() * v.squaredNorm()) return std::nullopt;
  const Eigen::Vector3d direction =
      length > kTouching ? Eigen::Vector3d(offset / length) : across.normalized();
  return SurfacePair{SurfacePair::edge_edge, i, j, ends_a, ends_b, {1 - s, s, 0}, {1 - t, t, 0}, direction,
                     direction.dot(offset)};
}

// Whether the direction n, from b to a, is an outward normal of both edges.
bool faces_other(const SurfaceState& a, int i, const SurfaceState& b, int j, const Eigen::Vector3d& n,
                 double slack) {
  return b.edge_cone_has(j, n, slack) && a.edge_cone_has(i, -n, slack);
}

// The contact of two edges, if there is one down to `depth`.
std::optional<SurfacePair> edge_pair(const SurfaceState& a, int i, const SurfaceState& b, int j, double reach,
                                     double depth) {
  std::optional<SurfacePair> pair = edges_across(a, i, b, j, std::max(reach, depth));
  if (!pair) return std::nullopt;
  const Eigen::Vector3d direction = pair->normal;
  const double length = pair->distance;
  const auto faces = [&](const Eigen::Vector3d& n) { return faces_other(a, i, b, j, n, kConeSlack); };
  const auto turned = [&] {
    pair->normal = -direction;
    pair->distance = -length;
  };
  if (std::abs(length) <= kTouching) {
    if (!faces(direction)) turned();
    return faces(pair->normal) ? pair : std::nullopt;
  }
  if (length <= reach && faces(direction)) return pair;
  if (length > depth || !faces(-direction)) return std::nullopt;
  turned();
  return pair;
}

// Whether a solid has y, or all but has it; shells and rods have no inside that could tell.
bool may_have(const SurfaceState& body, const Eigen::Vector3d& y, double slack) {
  if (body.surface().two_sided) return true;
  const std::optional<SurfacePlace> place = body.nearest(y, INFINITY);
  return place && place->distance <= slack;
}

void sort_pairs(std::vector<SurfacePair>& pairs) {
  std::sort(pairs.begin(), pairs.end(), [](const SurfacePair& u, const SurfacePair& v) {
    return std::tie(u.kind, u.feature_a, u.feature_b) < std::tie(v.kind, v.feature_a, v.feature_b);
  });
}

}  // namespace

std::optional<SurfacePair> kept_edge_pair(const SurfaceState& a, int edge_a, const SurfaceState& b,
                                          int edge_b, const Eigen::Vector3d& normal) {
  std::optional<SurfacePair> pair = edges_across(a, edge_a, b, edge_b, INFINITY);
  if (pair && pair->normal.dot(normal) < 0) {
    pair->normal = -pair->normal;
    pair->distance = -pair->distance;
  }
  return pair && faces_other(a, edge_a, b, edge_b, pair->normal, kKeptSlack) ? pair : std::nullopt;
}

bool boxes_near(const SurfaceState& a, const SurfaceState& b, double reach) {
  return !a.side_tree().empty() && !b.side_tree().empty() && box_distance2(a.box(), b.box()) <= reach * reach;
}

std::vector<SurfacePair> near_pairs(const SurfaceState& a, const SurfaceState& b, double reach) {
  if (a.surface().planar() != b.surface().planar()) {
    throw Error(ErrorKind::internal, "surfaces of the plane and of space do not touch");
  }
  std::vector<SurfacePair> pairs;
  if (!boxes_near(a, b, reach)) return pairs;
  add_point_pairs(a, b, reach, false, pairs);
  add_point_pairs(b, a, reach, true, pairs);
  const bool may_cross = !a.surface().two_sided || !b.surface().two_sided;
  const double depth =
      may_cross ? std::max(reach, kCrossingDepth * std::min(a.mean_edge(), b.mean_edge())) : 0;
  BoxTree::visit_pairs(a.edge_tree(), b.edge_tree(), std::max(reach, depth), [&](int i, int j) {
    const std::optional<SurfacePair> pair = edge_pair(a, i, b, j, reach, depth);
    if (!pair) return;
    if (pair->distance < -kTouching) {  // crossed only if what lies between the edges is inside both
      const Eigen::Vector3d y_b =
          pair->weight_b[0] * b.point(pair->b[0]) + pair->weight_b[1] * b.point(pair->b[1]);
      const Eigen::Vector3d middle = y_b + pair->distance / 2 * pair->normal;
      const double slack = -kConeSlack * pair->distance;
      if (!may_have(a, middle, slack) || !may_have(b, middle, slack)) return;
    }
    pairs.push_back(*pair);
  });
  sort_pairs(pairs);
  return pairs;
}

std::vector<SurfacePair> near_self_pairs(const SurfaceState& a, double reach) {
  const ContactSurface& surface = a.surface();
  const Points& rest = surface.rest;
  const double apart = kRestShare * reach;
  const auto rest_point = [&](int i) -> Eigen::Vector3d { return rest.row(i).transpose(); };
  const auto rest_distance = [&](int p, int side) {
    const std::array<int, 3> c = points_of(a.sides(), side);
    const TrianglePlace place =
        surface.planar()
            ? nearest_on_segment(rest_point(p), rest_point(c[0]), rest_point(c[1]))
            : nearest_on_triangle(rest_point(p), rest_point(c[0]), rest_point(c[1]), rest_point(c[2]));
    return (place.position - rest_point(p)).norm();
  };
  const auto squashed = [&](double distance, double at_rest) { return distance < -kSquashed * at_rest; };

  std::vector<SurfacePair> pairs;
  for (int p = 0; p < a.points().rows(); ++p) {
    const Eigen::Vector3d normal = surface.two_sided ? Eigen::Vector3d::Zero() : a.point_normal(p);
    const std::optional<SurfacePlace> place = a.nearest_allowed(a.point(p), reach, [&](int side) {
      return !share_points({p, -1, -1}, points_of(a.sides(), side)) &&
             (surface.two_sided || normal.dot(a.side_normal(side)) < 0) && rest_distance(p, side) >= apart;
    });
    if (!place || squashed(place->distance, rest_distance(p, place->side))) continue;
    pairs.push_back(point_pair(p, *place));
  }
  BoxTree::visit_pairs(a.edge_tree(), a.edge_tree(), reach, [&](int i, int j) {
    if (i >= j || share_points(points_of(surface.edges, i), points_of(surface.edges, j))) return;
    const std::optional<SurfacePair> pair = edge_pair(a, i, a, j, reach, surface.two_sided ? 0 : reach);
    if (!pair) return;
    const double at_rest = nearest_on_segments(rest_point(pair->a[0]), rest_point(pair->a[1]),
                                               rest_point(pair->b[0]), rest_point(pair->b[1]))
                               .offset.norm();
    if (at_rest < apart || squashed(pair->distance, at_rest)) return;
    pairs.push_back(*pair);
  });
  sort_pairs(pairs);
  return pairs;
}

}  // namespace vivify::sim
