#include "sim/contact/closest_points.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace vivify::sim {
namespace {

constexpr double kFlat2 = 1e-20;      // squared sine of a corner's angle: below, a triangle has no area
constexpr double kParallel2 = 1e-12;  // of the angle of two segments: below, they are parallel

}  // namespace

TrianglePlace nearest_on_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                 const Eigen::Vector3d& b) {
  const Eigen::Vector3d ab = b - a;
  const double along = ab.dot(p - a), length2 = ab.squaredNorm();
  if (along <= 0) return {a, {1, 0, 0}, 1};
  if (along >= length2) return {b, {0, 1, 0}, 2};
  const double t = along / length2;
  return {a + t * ab, {1 - t, t, 0}, 4};
}

TrianglePlace nearest_on_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                  const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a;
  if (ab.cross(ac).squaredNorm() <= kFlat2 * ab.squaredNorm() * ac.squaredNorm() || b == c) {
    const std::array<const Eigen::Vector3d*, 3> corner = {&a, &b, &c};
    TrianglePlace best{};
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      const TrianglePlace side = nearest_on_segment(p, *corner[k], *corner[next]);
      if (k > 0 && (side.position - p).squaredNorm() >= (best.position - p).squaredNorm()) continue;
      best = {side.position, {}, side.feature == 4 ? 4 + k : 1 + (side.feature == 1 ? k : next)};
      best.weights[k] = side.weights[0];
      best.weights[next] = side.weights[1];
    }
    return best;
  }
  const double d1 = ab.dot(p - a), d2 = ac.dot(p - a);
  if (d1 <= 0 && d2 <= 0) return {a, {1, 0, 0}, 1};
  const double d3 = ab.dot(p - b), d4 = ac.dot(p - b);
  if (d3 >= 0 && d4 <= d3) return {b, {0, 1, 0}, 2};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double t = d1 / (d1 - d3);
    return {a + ab * t, {1 - t, t, 0}, 4};
  }
  const double d5 = ab.dot(p - c), d6 = ac.dot(p - c);
  if (d6 >= 0 && d5 <= d6) return {c, {0, 0, 1}, 3};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double t = d2 / (d2 - d6);
    return {a + ac * t, {1 - t, 0, t}, 6};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {b + (c - b) * t, {0, 1 - t, t}, 5};
  }
  const double scale = 1 / (va + vb + vc), v = vb * scale, w = vc * scale;
  return {a + ab * v + ac * w, {1 - v - w, v, w}, 0};
}

SegmentPlaces nearest_on_segments(const Eigen::Vector3d& a0, const Eigen::Vector3d& a1,
                                  const Eigen::Vector3d& b0, const Eigen::Vector3d& b1) {
  const Eigen::Vector3d u = a1 - a0, v = b1 - b0, w = a0 - b0;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), uw = u.dot(w), vw = v.dot(w);
  const double determinant = u.cross(v).squaredNorm();
  if (determinant > kParallel2 * uu * vv) {
    const double s = (uv * vw - vv * uw) / determinant, t = (uu * vw - uv * uw) / determinant;
    if (s >= 0 && s <= 1 && t >= 0 && t <= 1) return {s, t, w + s * u - t * v};
  }
  // Otherwise an end of one of them is nearest to the other.
  SegmentPlaces best{0, 0, Eigen::Vector3d::Constant(INFINITY)};
  const auto consider = [&](double s, double t) {
    const Eigen::Vector3d offset = w + s * u - t * v;
    if (!(offset.squaredNorm() >= best.offset.squaredNorm())) best = {s, t, offset};
  };
  const auto share = [](double along, double length2) {
    return along <= 0 ? 0.0 : along >= length2 ? 1.0 : along / length2;
  };
  consider(0, share(vw, vv));
  consider(1, share(vw + uv, vv));
  consider(share(-uw, uu), 0);
  consider(share(uv - uw, uu), 1);
  return best;
}

double corner_angle(const Eigen::Vector3d& corner, const Eigen::Vector3d& next, const Eigen::Vector3d& last) {
  const Eigen::Vector3d u = next - corner, v = last - corner;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

Eigen::Vector3d unit_or(const Eigen::Vector3d& v, const Eigen::Vector3d& fallback) {
  const double length = v.norm();
  return length > 0 ? Eigen::Vector3d(v / length) : fallback;
}

}  // namespace vivify::sim
