#include "meshing/planar_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "common/error.h"
#include "meshing/polyline.h"
#include "meshing/refine_plane.h"

namespace vivify::meshing {
namespace {

constexpr double kCountTolerance = 0.15;
constexpr double kEnough = 0.02;     // the search for the size ends this near to the wanted number
constexpr double kDeviation = 0.04;  // of the coarsened outline from the outline, over the edge length
constexpr std::array<double, 3> kShapeBounds = {0.125, 0.04, 0};  // sin² of the least angle, tried in turn

// The loop with corners kept, curves replaced by chords within kDeviation * size, and edges of at most
// `size`.
Points2 coarsened(const Points2& loop, double size, double deviation) {
  std::vector<int> corners = corners_of(loop, true);
  if (corners.empty()) corners.push_back(0);
  std::vector<Eigen::RowVector2d> points;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const Points2 part = simplify(section(loop, corners[c], corners[(c + 1) % corners.size()]), deviation);
    for (Eigen::Index i = 0; i + 1 < part.rows(); ++i) {
      const Eigen::RowVector2d a = part.row(i), b = part.row(i + 1);
      const int pieces = std::max(1, static_cast<int>(std::ceil((b - a).norm() / size)));
      for (int k = 0; k < pieces; ++k) points.emplace_back(a + (b - a) * k / pieces);
    }
  }
  Points2 result(static_cast<Eigen::Index>(points.size()), 2);
  for (std::size_t i = 0; i < points.size(); ++i) result.row(static_cast<Eigen::Index>(i)) = points[i];
  return result;
}

// As above for all loops, with less deviation where they would meet or collapse.
std::vector<Points2> coarsened(const Outline& outline, double size) {
  for (double deviation = kDeviation * size; deviation > 1e-6 * size; deviation /= 4) {
    std::vector<Points2> loops;
    bool whole = true;
    for (const Points2& loop : outline.loops) {
      loops.push_back(coarsened(loop, size, deviation));
      whole = whole && loops.back().rows() >= 3 && signed_area(loops.back()) * signed_area(loop) > 0;
    }
    if (whole && meeting_edges(loops).first < 0) return loops;
  }
  return outline.loops;
}

std::optional<PlaneTriangles> attempt(const Outline& outline, double size, double shape_bound,
                                      Eigen::Index most) {
  return refine_plane(coarsened(outline, size),
                      {.longest_edge = size, .least_sine_squared = shape_bound, .most_vertices = most});
}

// Sine of the smallest angle, for comparing; negative for a triangle that is turned.
double quality(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const double doubled = cross2(b - a, c - a);
  const double ab = (b - a).squaredNorm(), bc = (c - b).squaredNorm(), ca = (a - c).squaredNorm();
  // The smallest angle is opposite to the shortest side: sine = doubled area / (product of the longer ones).
  return doubled / std::sqrt(ab * bc * ca / std::min({ab, bc, ca}));
}

// Rows of V in the order of their coordinates.
void sort_vertices(Points2& V, Triangles& F) {
  std::vector<int> order(static_cast<std::size_t>(V.rows())), place(order.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return std::pair(V(a, 0), V(a, 1)) < std::pair(V(b, 0), V(b, 1)); });
  for (std::size_t i = 0; i < order.size(); ++i) {
    place[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
  }
  V = V(order, Eigen::all).eval();
  std::vector<std::array<int, 3>> faces;
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    std::array<int, 3> face;
    for (int k = 0; k < 3; ++k) {
      face[static_cast<std::size_t>(k)] = place[static_cast<std::size_t>(F(f, k))];
    }
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    faces.push_back(face);
  }
  std::sort(faces.begin(), faces.end());
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    const auto& face = faces[static_cast<std::size_t>(f)];
    F.row(f) << face[0], face[1], face[2];
  }
}

class Improver {
 public:
  Improver(Points2& V, Triangles& F) : V_(V), F_(F) { connect(); }

  void run(int passes) {
    for (int pass = 0; pass < passes; ++pass) {
      for (int v = 0; v < V_.rows(); ++v) move(v);
      if (exchange_edges()) connect();
    }
  }

 private:
  Eigen::Vector2d at(int v) const { return V_.row(v); }

  void connect() {
    faces_.assign(static_cast<std::size_t>(V_.rows()), {});
    boundary_.assign(faces_.size(), 0);
    std::map<std::pair<int, int>, int> edges;
    for (int f = 0; f < F_.rows(); ++f) {
      for (int k = 0; k < 3; ++k) {
        faces_[static_cast<std::size_t>(F_(f, k))].push_back(f);
        edges[std::minmax(F_(f, k), F_(f, (k + 1) % 3))] += 1;
      }
    }
    for (const auto& [edge, count] : edges) {
      if (count != 1) continue;
      boundary_[static_cast<std::size_t>(edge.first)] = boundary_[static_cast<std::size_t>(edge.second)] = 1;
    }
  }

  double worst_around(int v) const {
    double worst = 1;
    for (const int f : faces_[static_cast<std::size_t>(v)]) {
      worst = std::min(worst, quality(at(F_(f, 0)), at(F_(f, 1)), at(F_(f, 2))));
    }
    return worst;
  }

  // Towards the mean of the neighbours' triangles, as far as the worst triangle gets no worse.
  void move(int v) {
    const auto& faces = faces_[static_cast<std::size_t>(v)];
    if (faces.empty() || boundary_[static_cast<std::size_t>(v)] != 0) return;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double total = 0;
    for (const int f : faces) {
      const Eigen::Vector2d a = at(F_(f, 0)), b = at(F_(f, 1)), c = at(F_(f, 2));
      const double area = std::abs(cross2(b - a, c - a));
      sum += area * (a + b + c) / 3;
      total += area;
    }
    const Eigen::Vector2d from = at(v), step = sum / total - from;
    const double before = worst_around(v);
    for (double part = 1; part > 0.1; part /= 2) {
      V_.row(v) = from + part * step;
      if (worst_around(v) > before) return;
    }
    V_.row(v) = from;
  }

  // Each pair of triangles takes the diagonal that gives the larger smallest angle.
  bool exchange_edges() {
    std::map<std::pair<int, int>, std::pair<int, int>> left;  // directed edge -> face, corner across
    for (int f = 0; f < F_.rows(); ++f) {
      for (int k = 0; k < 3; ++k) left[{F_(f, k), F_(f, (k + 1) % 3)}] = {f, F_(f, (k + 2) % 3)};
    }
    std::vector<char> changed(static_cast<std::size_t>(F_.rows()), 0);
    bool any = false;
    for (const auto& [edge, side] : left) {
      const auto [a, b] = edge;
      const auto other = left.find({b, a});
      if (a > b || other == left.end()) continue;
      const auto [f, c] = side;
      const auto [g, d] = other->second;
      if (changed[static_cast<std::size_t>(f)] != 0 || changed[static_cast<std::size_t>(g)] != 0) continue;
      const double now = std::min(quality(at(a), at(b), at(c)), quality(at(b), at(a), at(d)));
      const double then = std::min(quality(at(c), at(d), at(b)), quality(at(d), at(c), at(a)));
      if (!(then > now * (1 + 1e-9))) continue;
      F_.row(f) << c, d, b;
      F_.row(g) << d, c, a;
      changed[static_cast<std::size_t>(f)] = changed[static_cast<std::size_t>(g)] = 1;
      any = true;
    }
    return any;
  }

  Points2& V_;
  Triangles& F_;
  std::vector<std::vector<int>> faces_;
  std::vector<char> boundary_;
};

}  // namespace

double min_angle(const Points2& V, const Triangles& F) {
  double smallest = std::numbers::pi;
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector2d a = V.row(F(f, k)), u = V.row(F(f, (k + 1) % 3)).transpose() - a,
                            v = V.row(F(f, (k + 2) % 3)).transpose() - a;
      smallest = std::min(smallest, std::atan2(cross2(u, v), u.dot(v)));
    }
  }
  return smallest * 180 / std::numbers::pi;
}

void improve_triangles(Points2& V, Triangles& F, int passes) { Improver(V, F).run(passes); }

PlanarMesh triangulate_outline(const Outline& outline, int vertices) {
  const double area = outline.area();
  if (outline.loops.empty() || !(area > 0)) throw Error(ErrorKind::geometry, "the outline has no area");
  const auto deviation = [&](const PlaneTriangles& mesh) {
    return std::abs(static_cast<double>(mesh.V.rows()) / vertices - 1);
  };
  std::optional<PlaneTriangles> best;
  Eigen::Index fewest = 0;
  for (const double shape_bound : kShapeBounds) {
    // The number of vertices falls with the size, not quite steadily: bisection in the logarithm.
    double small = std::log(std::sqrt(area / vertices) / 4),
           large = std::log(box_of(outline.loops).diagonal().norm());
    for (int step = 0; step < 24 && large - small > 1e-3; ++step) {
      const double size = step == 0 ? std::log(1.6 * std::sqrt(area / vertices)) : (small + large) / 2;
      const Eigen::Index most = 2 * vertices + 20;
      std::optional<PlaneTriangles> mesh = attempt(outline, std::exp(size), shape_bound, most);
      const bool too_many = !mesh || mesh->V.rows() > vertices;
      (too_many ? small : large) = size;
      if (!mesh) continue;
      if (fewest == 0 || mesh->V.rows() < fewest) fewest = mesh->V.rows();
      if (!best || deviation(*mesh) < deviation(*best)) best = std::move(mesh);
      if (deviation(*best) <= kEnough) break;
    }
    if (best && deviation(*best) <= kCountTolerance) break;
  }
  if (!best || deviation(*best) > kCountTolerance) {
    throw Error(ErrorKind::geometry,
                "the outline cannot be meshed with " + std::to_string(vertices) + " vertices" +
                    (best ? "; the nearest is " + std::to_string(best->V.rows()) : ""),
                "ask for more vertices, or simplify the outline: it has " +
                    std::to_string(outline.corners()) + " corners in " +
                    std::to_string(outline.loops.size()) + " loops");
  }
  PlanarMesh result;
  result.V = std::move(best->V);
  result.F = std::move(best->F);
  improve_triangles(result.V, result.F);
  sort_vertices(result.V, result.F);
  result.min_angle = min_angle(result.V, result.F);
  double sum = 0;
  for (Eigen::Index f = 0; f < result.F.rows(); ++f) {
    const Eigen::Vector2d a = result.V.row(result.F(f, 0)), b = result.V.row(result.F(f, 1)),
                          c = result.V.row(result.F(f, 2));
    sum += cross2(b - a, c - a) / 2;
  }
  result.area_ratio = sum / area;
  return result;
}

}  // namespace vivify::meshing
