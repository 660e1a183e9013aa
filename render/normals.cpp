#include "render/normals.h"

#include <algorithm>
#include <numeric>

namespace vivify::render {
namespace {

// For every point, the smallest index of a point at the same place.
std::vector<std::uint32_t> weld(const std::vector<Vec3>& points) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    const Vec3& p = points[a];
    const Vec3& q = points[b];
    if (p.x != q.x) return p.x < q.x;
    if (p.y != q.y) return p.y < q.y;
    if (p.z != q.z) return p.z < q.z;
    return a < b;
  };
  std::sort(order.begin(), order.end(), before);
  std::vector<std::uint32_t> place(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && points[order[i]] == points[order[i - 1]];
    place[order[i]] = same ? place[order[i - 1]] : order[i];
  }
  return place;
}

float corner_angle(const Vec3& at, const Vec3& b, const Vec3& c) {
  const Vec3 e = b - at;
  const Vec3 f = c - at;
  return std::atan2(length(cross(e, f)), dot(e, f));
}

}  // namespace

std::vector<Vec3> corner_normals(const std::vector<Vec3>& points,
                                 const std::vector<std::array<std::uint32_t, 3>>& triangles, float crease) {
  const std::vector<std::uint32_t> place = weld(points);
  std::vector<Vec3> face(triangles.size());
  std::vector<float> angle(3 * triangles.size());
  std::vector<std::uint32_t> first(points.size() + 1, 0);  // corners by place
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    const auto& t = triangles[f];
    const Vec3 n = cross(points[t[1]] - points[t[0]], points[t[2]] - points[t[0]]);
    const float size = length(n);
    face[f] = size > 0 ? n / size : Vec3();
    for (std::size_t k = 0; k < 3; ++k) {
      angle[3 * f + k] = corner_angle(points[t[k]], points[t[(k + 1) % 3]], points[t[(k + 2) % 3]]);
      ++first[place[t[k]] + 1];
    }
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::uint32_t> corners(3 * triangles.size());
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  for (std::uint32_t c = 0; c < corners.size(); ++c) corners[next[place[triangles[c / 3][c % 3]]]++] = c;

  const float limit = std::cos(crease);
  std::vector<Vec3> normals(3 * triangles.size());
  for (std::uint32_t c = 0; c < normals.size(); ++c) {
    const Vec3& own = face[c / 3];
    const std::uint32_t p = place[triangles[c / 3][c % 3]];
    Vec3 sum;
    for (std::uint32_t i = first[p]; i < first[p + 1]; ++i) {
      const Vec3& other = face[corners[i] / 3];
      if (is_zero(own) || dot(own, other) >= limit) sum += other * angle[corners[i]];
    }
    const float size = length(sum);
    normals[c] = size > 0 ? sum / size : is_zero(own) ? Vec3(0, 1, 0) : own;
  }
  return normals;
}

}  // namespace vivify::render
