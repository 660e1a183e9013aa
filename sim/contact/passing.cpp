#include "sim/contact/passing.h"

#include <cmath>

namespace vivify::sim {
namespace {

constexpr double kLedge = 0.5;  // of the gap: how far surfaces that are flush may be from each other

constexpr double kAlike = 0.5;  // cosine of two normals; such places are found again after the step
constexpr int kLooks = 8;       // parts of a way at whose ends a point must be outside

}  // namespace

Eigen::Vector3d place_of(const SurfaceState& surface, const std::array<int, 3>& points,
                         const std::array<double, 3>& weights) {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    if (points[k] >= 0) place += weights[k] * surface.point(points[k]);
  }
  return place;
}

void follow_passing(SurfacePair& pair, const SurfaceState& a, const SurfaceState& b,
                    const Eigen::Vector3d& move, double apart) {
  const bool point_of_a = pair.kind == SurfacePair::point_face;
  const SurfaceState &point = point_of_a ? a : b, &face = point_of_a ? b : a;
  if (pair.kind == SurfacePair::edge_edge || face.surface().two_sided) return;
  const double radii = a.surface().radius + b.surface().radius;
  if (pair.distance < radii || pair.distance + pair.normal.dot(move) > radii) return;
  const Eigen::Vector3d y = point.point(point_of_a ? pair.feature_a : pair.feature_b);
  const Eigen::Vector3d way = point_of_a ? move : -move;
  const std::optional<SurfacePlace> there = face.nearest(y + way, INFINITY);
  if (!there || there->distance < radii + apart) return;
  const Eigen::Vector3d normal = point_of_a ? there->normal : -there->normal;
  if (normal.dot(pair.normal) > kAlike) return;
  for (int k = 1; k < kLooks; ++k) {
    const std::optional<SurfacePlace> between = face.nearest(y + k * way / kLooks, INFINITY);
    if (between && between->distance < radii - apart) return;
  }
  pair.normal = normal;
  (point_of_a ? pair.b : pair.a) = there->points;
  (point_of_a ? pair.weight_b : pair.weight_a) = there->weights;
}

bool is_covered(const Eigen::Vector3d& y, const Eigen::Vector3d& n, const SurfaceState& body,
                const SurfaceState& cover, double gap) {
  const double away = body.surface().radius + gap, cover_radius = cover.surface().radius;
  const Eigen::Vector3d beside = y + away * n;
  const double reach = cover_radius + gap;
  if (cover.box().squaredExteriorDistance(beside) > reach * reach) return false;
  const std::optional<SurfacePlace> there = cover.nearest(beside, reach);
  if (!there || there->distance > cover_radius + kLedge * gap) return false;
  const std::optional<SurfacePlace> own = body.nearest(y + away * there->normal, 2 * away);
  return own && own->distance > away - kLedge * gap;
}

}  // namespace vivify::sim
