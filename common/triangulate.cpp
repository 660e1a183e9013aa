#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "common/polygon_mesh.h"

namespace vivify {
namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

bool inside(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b,
            const Eigen::Vector2d& c) {
  return cross(b - a, p - a) >= 0 && cross(c - b, p - b) >= 0 && cross(a - c, p - c) >= 0;
}

}  // namespace

std::vector<Eigen::Vector3i> triangulate(const std::vector<Eigen::Vector3d>& corners) {
  const auto count = static_cast<int>(corners.size());
  if (count == 3) return {{0, 1, 2}};

  // Seen along the area vector, the polygon is counter-clockwise.
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    area += (corners[i] - corners[0]).cross(corners[i + 1] - corners[0]);
  }
  int drop = 0;
  area.cwiseAbs().maxCoeff(&drop);
  const int first = (drop + 1) % 3, second = (drop + 2) % 3;
  const double turn = area[drop] < 0 ? -1 : 1;
  std::vector<Eigen::Vector2d> flat;
  for (const Eigen::Vector3d& corner : corners) flat.emplace_back(corner[first], turn * corner[second]);

  std::vector<int> left(corners.size());
  for (int i = 0; i < count; ++i) left[static_cast<std::size_t>(i)] = i;
  std::vector<Eigen::Vector3i> triangles;
  const auto at = [&](int i) { return flat[static_cast<std::size_t>(i)]; };
  while (left.size() > 3) {
    // Of the ears, the one whose smallest angle is largest; without any (a polygon that crosses itself), the
    // first corner.
    const std::size_t n = left.size();
    std::size_t best = 0;
    double best_shape = -1;
    for (std::size_t k = 0; k < n; ++k) {
      const int ia = left[(k + n - 1) % n], ib = left[k], ic = left[(k + 1) % n];
      const Eigen::Vector2d a = at(ia), b = at(ib), c = at(ic);
      const double doubled = cross(b - a, c - b);
      if (!(doubled > 0)) continue;
      const bool blocked = std::any_of(left.begin(), left.end(), [&](int i) {
        return i != ia && i != ib && i != ic && at(i) != a && at(i) != b && at(i) != c &&
               inside(at(i), a, b, c);
      });
      if (blocked) continue;
      const double shape =
          doubled / std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
      if (shape > best_shape) {
        best_shape = shape;
        best = k;
      }
    }
    triangles.emplace_back(left[(best + n - 1) % n], left[best], left[(best + 1) % n]);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
  }
  triangles.emplace_back(left[0], left[1], left[2]);
  return triangles;
}

}  // namespace vivify
