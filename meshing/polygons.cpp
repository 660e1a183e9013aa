#include "meshing/polygons.h"

#include <algorithm>
#include <clipper.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace vivify::meshing {
namespace {

// Coordinates on Clipper's grid: the box of the input takes 2^29 steps, so that products fit in 64 bits.
class Grid {
 public:
  explicit Grid(const Eigen::AlignedBox2d& box, double margin = 0)
      : origin_(box.center()), scale_(std::ldexp(1.0, 29) / (box.sizes().maxCoeff() / 2 + margin)) {}

  ClipperLib::IntPoint to_grid(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d q = (p - origin_) * scale_;
    return {std::llround(q.x()), std::llround(q.y())};
  }
  Eigen::Vector2d from_grid(const ClipperLib::IntPoint& p) const {
    return origin_ + Eigen::Vector2d(static_cast<double>(p.X), static_cast<double>(p.Y)) / scale_;
  }
  double steps(double length) const { return length * scale_; }

  ClipperLib::Paths to_grid(const std::vector<Points2>& loops) const {
    ClipperLib::Paths paths;
    for (const Points2& loop : loops) {
      ClipperLib::Path path;
      for (Eigen::Index i = 0; i < loop.rows(); ++i) path.push_back(to_grid(Eigen::Vector2d(loop.row(i))));
      paths.push_back(std::move(path));
    }
    return paths;
  }

 private:
  Eigen::Vector2d origin_;
  double scale_;
};

using OriginalPoints = std::map<std::pair<ClipperLib::cInt, ClipperLib::cInt>, Eigen::Vector2d>;

std::vector<Points2> from_grid(const ClipperLib::Paths& paths, const Grid& grid,
                               const OriginalPoints& original, double least_area) {
  std::vector<Points2> loops;
  for (const ClipperLib::Path& path : paths) {
    if (path.size() < 3) continue;
    std::vector<Eigen::Vector2d> points;
    for (const ClipperLib::IntPoint& p : path) {
      const auto found = original.find({p.X, p.Y});
      points.push_back(found == original.end() ? grid.from_grid(p) : found->second);
    }
    const auto lowest = std::min_element(points.begin(), points.end(),
                                         [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
                                           return std::pair(a.y(), a.x()) < std::pair(b.y(), b.x());
                                         });
    std::rotate(points.begin(), lowest, points.end());
    Points2 loop(static_cast<Eigen::Index>(points.size()), 2);
    for (std::size_t i = 0; i < points.size(); ++i) loop.row(static_cast<Eigen::Index>(i)) = points[i];
    if (std::abs(signed_area(loop)) > least_area) loops.push_back(std::move(loop));
  }
  std::stable_sort(loops.begin(), loops.end(), [](const Points2& a, const Points2& b) {
    const double area_a = std::abs(signed_area(a)), area_b = std::abs(signed_area(b));
    if (area_a != area_b) return area_a > area_b;
    return std::pair(a(0, 1), a(0, 0)) < std::pair(b(0, 1), b(0, 0));
  });
  return loops;
}

double orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return cross2(b - a, c - a);
}

}  // namespace

double signed_area(const Points2& polygon) {
  double doubled = 0;
  const Eigen::Index n = polygon.rows();
  for (Eigen::Index i = 1; i + 1 < n; ++i) {
    doubled += cross2((polygon.row(i) - polygon.row(0)).transpose(),
                      (polygon.row(i + 1) - polygon.row(0)).transpose());
  }
  return doubled / 2;
}

double perimeter(const Points2& polygon) {
  double sum = 0;
  for (Eigen::Index i = 0; i < polygon.rows(); ++i) {
    sum += (polygon.row((i + 1) % polygon.rows()) - polygon.row(i)).norm();
  }
  return sum;
}

Eigen::AlignedBox2d box_of(const Points2& points) {
  Eigen::AlignedBox2d box;
  for (Eigen::Index i = 0; i < points.rows(); ++i) box.extend(points.row(i).transpose());
  return box;
}

Eigen::AlignedBox2d box_of(const std::vector<Points2>& polygons) {
  Eigen::AlignedBox2d box;
  for (const Points2& polygon : polygons) box.extend(box_of(polygon));
  return box;
}

Eigen::VectorXd turning_angles(const Points2& polygon) {
  const Eigen::Index n = polygon.rows();
  Eigen::VectorXd angles(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector2d in = polygon.row(i) - polygon.row((i + n - 1) % n),
                          out = polygon.row((i + 1) % n) - polygon.row(i);
    angles[i] = std::atan2(cross2(in, out), in.dot(out));
  }
  return angles;
}

std::vector<Points2> fill(const std::vector<Points2>& contours, FillRule rule) {
  const Eigen::AlignedBox2d box = box_of(contours);
  if (box.isEmpty() || !(box.sizes().maxCoeff() > 0)) return {};
  const Grid grid(box);
  const ClipperLib::Paths paths = grid.to_grid(contours);
  OriginalPoints original;
  for (std::size_t k = 0; k < paths.size(); ++k) {
    for (std::size_t i = 0; i < paths[k].size(); ++i) {
      original.emplace(std::pair(paths[k][i].X, paths[k][i].Y),
                       contours[k].row(static_cast<Eigen::Index>(i)));
    }
  }
  const auto fill_type = rule == FillRule::nonzero ? ClipperLib::pftNonZero : ClipperLib::pftEvenOdd;
  ClipperLib::Clipper clipper(ClipperLib::ioStrictlySimple);
  clipper.AddPaths(paths, ClipperLib::ptSubject, true);
  ClipperLib::Paths filled;
  clipper.Execute(ClipperLib::ctUnion, filled, fill_type, fill_type);
  return from_grid(filled, grid, original, 1e-9 * box.volume());
}

std::vector<Points2> offset(const std::vector<Points2>& loops, double distance, double tolerance) {
  const Eigen::AlignedBox2d box = box_of(loops);
  if (box.isEmpty()) return {};
  const Grid grid(box, std::max(0.0, distance));
  ClipperLib::ClipperOffset offsetter(2, grid.steps(tolerance));
  offsetter.AddPaths(grid.to_grid(loops), ClipperLib::jtRound, ClipperLib::etClosedPolygon);
  ClipperLib::Paths moved;
  offsetter.Execute(moved, grid.steps(distance));
  return from_grid(moved, grid, {}, 1e-9 * box.volume());
}

int winding_number(const std::vector<Points2>& loops, const Eigen::Vector2d& p) {
  int winding = 0;
  for (const Points2& loop : loops) {
    for (Eigen::Index i = 0; i < loop.rows(); ++i) {
      const Eigen::Vector2d a = loop.row(i), b = loop.row((i + 1) % loop.rows());
      if (a.y() <= p.y() && b.y() > p.y() && orientation(a, b, p) > 0) ++winding;
      if (b.y() <= p.y() && a.y() > p.y() && orientation(a, b, p) < 0) --winding;
    }
  }
  return winding;
}

double distance_to_segment(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d edge = b - a;
  const double length = edge.squaredNorm();
  const double t = length > 0 ? std::clamp((p - a).dot(edge) / length, 0.0, 1.0) : 0;
  return (a + t * edge - p).norm();
}

double distance_to(const std::vector<Points2>& loops, const Eigen::Vector2d& p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Points2& loop : loops) {
    for (Eigen::Index i = 0; i < loop.rows(); ++i) {
      nearest = std::min(nearest, distance_to_segment(p, loop.row(i), loop.row((i + 1) % loop.rows())));
    }
  }
  return nearest;
}

std::vector<int> points_not_inside(const Points2& polygon, const Points2& points, double clearance) {
  const std::vector<Points2> loops = {polygon};
  std::vector<int> outside;
  for (int i = 0; i < points.rows(); ++i) {
    const Eigen::Vector2d p = points.row(i);
    const double distance = distance_to(loops, p);
    if (winding_number(loops, p) != 1 || distance < clearance || distance == 0) outside.push_back(i);
  }
  return outside;
}

bool segments_meet(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                   const Eigen::Vector2d& d) {
  if (std::max(a.x(), b.x()) < std::min(c.x(), d.x()) || std::max(c.x(), d.x()) < std::min(a.x(), b.x()) ||
      std::max(a.y(), b.y()) < std::min(c.y(), d.y()) || std::max(c.y(), d.y()) < std::min(a.y(), b.y())) {
    return false;
  }
  const auto sign = [](double x) { return (x > 0) - (x < 0); };
  return sign(orientation(a, b, c)) * sign(orientation(a, b, d)) <= 0 &&
         sign(orientation(c, d, a)) * sign(orientation(c, d, b)) <= 0;
}

std::pair<int, int> meeting_edges(const std::vector<Points2>& loops) {
  struct Edge {
    Eigen::Vector2d a, b;
    int id, next;
    double left() const { return std::min(a.x(), b.x()); }
    double right() const { return std::max(a.x(), b.x()); }
  };
  std::vector<Edge> edges;
  for (const Points2& loop : loops) {
    const int first = static_cast<int>(edges.size()), n = static_cast<int>(loop.rows());
    for (int i = 0; i < n; ++i) {
      edges.push_back({loop.row(i), loop.row((i + 1) % n), first + i, first + (i + 1) % n});
    }
  }
  const auto clash = [](const Edge& e, const Edge& f) {
    if (e.a == e.b || f.a == f.b) return true;  // an edge without length
    if (!segments_meet(e.a, e.b, f.a, f.b)) return false;
    const auto overlap = [](const Edge& first, const Edge& second) {  // around their common vertex
      const Eigen::Vector2d u = first.a - first.b, v = second.b - second.a;
      return cross2(u, v) == 0 && u.dot(v) > 0;
    };
    if (e.next == f.id) return overlap(e, f);
    if (f.next == e.id) return overlap(f, e);
    return true;
  };
  std::vector<std::size_t> order(edges.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return edges[i].left() < edges[j].left(); });
  std::pair<int, int> found(-1, -1);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Edge& e = edges[order[i]];
    for (std::size_t j = i + 1; j < order.size() && edges[order[j]].left() <= e.right(); ++j) {
      const Edge& f = edges[order[j]];
      if (!clash(e, f)) continue;
      const std::pair<int, int> pair = std::minmax(e.id, f.id);
      if (found.first < 0 || pair < found) found = pair;
    }
  }
  return found;
}

}  // namespace vivify::meshing
