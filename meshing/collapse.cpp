#include "meshing/collapse.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <optional>
#include <queue>
#include <tuple>
#include <vector>

namespace vivify::meshing {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Triangle = Kernel::Triangle_3;
using Segment = Kernel::Segment_3;
using Face = std::array<int, 3>;
using Eigen::Matrix4d;
using Eigen::Vector3d;
using Eigen::Vector4d;

constexpr double kLeastShape = 0.03;  // 4 sqrt(3) area / sum of squared edges; 1 for an equilateral triangle
constexpr double kSharpestEdge = -0.95;  // cosine between the normals beside an edge
constexpr int kTightenSweeps = 20;
constexpr double kRegularity = 1e-3;  // weight of short edges against flatness

Point to_point(const Vector3d& p) { return {p[0], p[1], p[2]}; }

// The triangles that the surface must not touch.
class Obstacle {
 public:
  explicit Obstacle(const TriangleMesh& mesh) {
    triangles_.reserve(static_cast<std::size_t>(mesh.F.rows()));
    for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
      const Triangle triangle(to_point(mesh.V.row(mesh.F(f, 0))), to_point(mesh.V.row(mesh.F(f, 1))),
                              to_point(mesh.V.row(mesh.F(f, 2))));
      if (!triangle.is_degenerate()) triangles_.push_back(triangle);
    }
    tree_.rebuild(triangles_.begin(), triangles_.end());
  }
  bool touches(const Triangle& triangle) const { return !triangles_.empty() && tree_.do_intersect(triangle); }

 private:
  using Iterator = std::vector<Triangle>::const_iterator;
  using Primitive = CGAL::AABB_triangle_primitive<Kernel, Iterator>;
  std::vector<Triangle> triangles_;
  CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>> tree_;
};

// The point with n_i . (p - a_i) >= 0 for all planes that makes `direction` . p least, among the corners of
// that region; nothing when it has none.
struct Plane {
  Vector3d normal;
  double offset;  // normal . p >= offset
};
std::optional<Vector3d> lowest_corner(const std::vector<Plane>& planes, const Vector3d& direction,
                                      double tolerance) {
  std::optional<Vector3d> best;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    for (std::size_t j = i + 1; j < planes.size(); ++j) {
      const Vector3d line = planes[i].normal.cross(planes[j].normal);
      for (std::size_t k = j + 1; k < planes.size(); ++k) {
        const double determinant = line.dot(planes[k].normal);
        if (std::abs(determinant) < 1e-3) continue;  // unit normals: nearly parallel planes meet far away
        const Vector3d p =
            (planes[i].offset * planes[j].normal.cross(planes[k].normal) +
             planes[j].offset * planes[k].normal.cross(planes[i].normal) + planes[k].offset * line) /
            determinant;
        if (best && direction.dot(p) >= direction.dot(*best)) continue;
        const bool outside = std::all_of(planes.begin(), planes.end(), [&](const Plane& plane) {
          return plane.normal.dot(p) >= plane.offset - tolerance;
        });
        if (outside) best = p;
      }
    }
  }
  return best;
}

class Collapser {
 public:
  Collapser(const TriangleMesh& surface, const TriangleMesh& enclosed)
      : obstacle_(enclosed), size_(bounding_box(surface.V).diagonal()) {
    for (Eigen::Index v = 0; v < surface.V.rows(); ++v) positions_.push_back(surface.V.row(v));
    star_.resize(positions_.size());
    version_.assign(positions_.size(), 0);
    quadrics_.assign(positions_.size(), Matrix4d::Zero());
    for (Eigen::Index f = 0; f < surface.F.rows(); ++f) {
      faces_.push_back({surface.F(f, 0), surface.F(f, 1), surface.F(f, 2)});
      alive_.push_back(1);
      const int id = static_cast<int>(f);
      const Vector3d area_normal = double_area_normal(id) / 2;
      const double area = area_normal.norm();
      Vector4d plane;
      plane << area_normal / area, -area_normal.dot(position(faces_.back()[0])) / area;
      for (const int v : faces_.back()) {
        star_[index(v)].push_back(id);
        quadrics_[index(v)] += area * plane * plane.transpose();
      }
    }
    vertices_ = static_cast<int>(std::count_if(star_.begin(), star_.end(),
                                               [](const std::vector<int>& star) { return !star.empty(); }));
  }

  void run(int wanted) {
    bool changed = true;
    while (changed && vertices_ > wanted) {  // what was not legal at first may be later
      changed = false;
      queue_all_edges();
      while (!queue_.empty() && vertices_ > wanted) {
        const Candidate candidate = queue_.top();
        queue_.pop();
        if (candidate.version_u != version_[index(candidate.u)] ||
            candidate.version_v != version_[index(candidate.v)]) {
          continue;
        }
        if (!keeps_topology(candidate) || !keeps_clear(candidate)) continue;
        collapse(candidate);
        changed = true;
      }
      queue_ = {};
    }
  }

  // Moves single vertices against the gradient of the volume as long as that is legal.
  void tighten(int sweeps) {
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      for (int v = 0; v < static_cast<int>(star_.size()); ++v) {
        if (star_[index(v)].empty()) continue;
        Vector3d gradient = Vector3d::Zero();
        for (const int f : star_[index(v)]) gradient += double_area_normal(f);
        double reach = 0;
        for (const int w : neighbours(v)) reach = std::max(reach, (position(w) - position(v)).norm());
        for (double step = 0.25; step > 0.01; step /= 2) {
          const Vector3d target = position(v) - step * reach * gradient.normalized();
          if (!keeps_clear({0, v, v, 0, 0, 0, target})) continue;
          positions_[index(v)] = target;
          break;
        }
      }
    }
  }

  TriangleMesh result() const {
    TriangleMesh mesh;
    std::vector<int> row(positions_.size(), -1);
    std::vector<int> kept;
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      if (star_[v].empty()) continue;
      row[v] = static_cast<int>(kept.size());
      kept.push_back(static_cast<int>(v));
    }
    mesh.V.resize(static_cast<Eigen::Index>(kept.size()), 3);
    for (std::size_t i = 0; i < kept.size(); ++i)
      mesh.V.row(static_cast<Eigen::Index>(i)) = position(kept[i]);
    mesh.F.resize(std::count(alive_.begin(), alive_.end(), char{1}), 3);
    Eigen::Index f = 0;
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      if (!alive_[i]) continue;
      mesh.F.row(f++) << row[index(faces_[i][0])], row[index(faces_[i][1])], row[index(faces_[i][2])];
    }
    return mesh;
  }

 private:
  // A way to collapse edge uv into one vertex at `target`.
  struct Candidate {
    double cost;
    int u, v, kind;
    int version_u, version_v;
    Vector3d target;
    bool operator<(const Candidate& other) const {  // the queue gives the greatest first
      return std::tie(cost, u, v, kind) > std::tie(other.cost, other.u, other.v, other.kind);
    }
  };

  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  const Vector3d& position(int v) const { return positions_[index(v)]; }

  Vector3d double_area_normal(int f) const {
    const Face& face = faces_[index(f)];
    return (position(face[1]) - position(face[0])).cross(position(face[2]) - position(face[0]));
  }

  std::vector<int> neighbours(int v) const {
    std::vector<int> ring;
    for (const int f : star_[index(v)]) {
      for (const int w : faces_[index(f)]) {
        if (w != v) ring.push_back(w);
      }
    }
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
    return ring;
  }

  // Faces around the edge: those of u, then those of v that u has not.
  std::vector<int> faces_around(int u, int v) const {
    std::vector<int> around = star_[index(u)];
    for (const int f : star_[index(v)]) {
      const Face& face = faces_[index(f)];
      if (std::find(face.begin(), face.end(), u) == face.end()) around.push_back(f);
    }
    return around;
  }

  void queue_all_edges() {
    for (int u = 0; u < static_cast<int>(star_.size()); ++u) {
      for (const int v : neighbours(u)) {
        if (u < v) queue_edge(u, v);
      }
    }
  }

  void queue_edge(int u, int v) {
    const Vector3d middle = 0.5 * (position(u) + position(v));
    const Matrix4d Q = quadrics_[index(u)] + quadrics_[index(v)];
    // A weak pull to the middle makes the optimum unique where the surface is flat.
    const double pull = 1e-3 * Q.topLeftCorner<3, 3>().trace();
    const Eigen::Matrix3d A = Q.topLeftCorner<3, 3>() + pull * Eigen::Matrix3d::Identity();
    const Vector3d best = A.ldlt().solve(pull * middle - Q.topRightCorner<3, 1>());

    std::vector<Vector3d> targets = {best, position(u), position(v)};
    std::vector<Plane> planes;
    Vector3d direction = Vector3d::Zero();
    for (const int f : faces_around(u, v)) {
      const Vector3d area_normal = double_area_normal(f);
      const Vector3d normal = area_normal.normalized();
      planes.push_back({normal, normal.dot(position(faces_[index(f)][0]))});
      direction += area_normal;
    }
    if (const auto outside = lowest_corner(planes, direction, 1e-9 * size_)) targets.push_back(*outside);

    for (std::size_t kind = 0; kind < targets.size(); ++kind) {
      const Vector3d& p = targets[kind];
      if ((p - middle).norm() > size_) continue;
      const Vector4d h = p.homogeneous();
      const double flatness = h.dot(Q * h);
      const double length =
          kRegularity * Q.topLeftCorner<3, 3>().trace() * (position(u) - position(v)).squaredNorm();
      queue_.push(
          {flatness + length, u, v, static_cast<int>(kind), version_[index(u)], version_[index(v)], p});
    }
  }

  // The triangles around the edge after the collapse.
  std::vector<Face> new_faces(const Candidate& c) const {
    std::vector<Face> result;
    for (const int f : faces_around(c.u, c.v)) {
      Face face = faces_[index(f)];
      std::replace(face.begin(), face.end(), c.v, c.u);
      if ((face[0] == c.u) + (face[1] == c.u) + (face[2] == c.u) == 1) result.push_back(face);
    }
    return result;
  }

  // The edge's ends share just the two opposite corners (link condition), and no vertex is left with two
  // faces.
  bool keeps_topology(const Candidate& c) const {
    if (vertices_ <= 4) return false;
    const std::vector<int> ring_u = neighbours(c.u), ring_v = neighbours(c.v);
    std::vector<int> common;
    std::set_intersection(ring_u.begin(), ring_u.end(), ring_v.begin(), ring_v.end(),
                          std::back_inserter(common));
    return common.size() == 2 && ring_u.size() + ring_v.size() >= 7 &&
           std::none_of(common.begin(), common.end(), [&](int w) { return neighbours(w).size() <= 3; });
  }

  // No new triangle is flipped, thin, folded or touches anything.
  bool keeps_clear(const Candidate& c) const {
    const std::vector<int> around = faces_around(c.u, c.v);
    const auto corner = [&](int v) { return v == c.u ? c.target : position(v); };
    const std::vector<Face> faces = new_faces(c);
    std::vector<Triangle> triangles;
    std::vector<Vector3d> normals;
    std::size_t next = 0;
    for (const int f : around) {
      const Face& old = faces_[index(f)];
      const bool has_u = std::find(old.begin(), old.end(), c.u) != old.end();
      const bool has_v = std::find(old.begin(), old.end(), c.v) != old.end();
      if (c.u != c.v && has_u && has_v) continue;
      const Face& face = faces[next++];
      const Vector3d p = corner(face[0]), q = corner(face[1]), r = corner(face[2]);
      const Vector3d normal = (q - p).cross(r - p);
      const double lengths = (q - p).squaredNorm() + (r - q).squaredNorm() + (p - r).squaredNorm();
      if (2 * std::sqrt(3.0) * normal.norm() < kLeastShape * lengths) return false;
      if (normal.dot(double_area_normal(f)) <= 0) return false;
      triangles.emplace_back(to_point(p), to_point(q), to_point(r));
      normals.push_back(normal.normalized());
    }
    return !folds(c, faces, normals, around) &&
           std::none_of(triangles.begin(), triangles.end(),
                        [&](const Triangle& t) { return obstacle_.touches(t); }) &&
           !meets_surface(c, faces, triangles, around);
  }

  // Whether an edge of a new face becomes sharper than the limit.
  bool folds(const Candidate& c, const std::vector<Face>& faces, const std::vector<Vector3d>& normals,
             const std::vector<int>& around) const {
    const auto shared = [](const Face& a, const Face& b) {
      return std::count_if(a.begin(), a.end(),
                           [&](int v) { return std::find(b.begin(), b.end(), v) != b.end(); });
    };
    for (std::size_t i = 0; i < faces.size(); ++i) {
      for (std::size_t j = i + 1; j < faces.size(); ++j) {
        if (shared(faces[i], faces[j]) == 2 && normals[i].dot(normals[j]) < kSharpestEdge) return true;
      }
      for (const int v : faces[i]) {
        if (v == c.u) continue;
        for (const int f : star_[index(v)]) {
          if (std::find(around.begin(), around.end(), f) != around.end()) continue;
          if (shared(faces[i], faces_[index(f)]) == 2 &&
              normals[i].dot(double_area_normal(f).normalized()) < kSharpestEdge) {
            return true;
          }
        }
      }
    }
    return false;
  }

  Triangle triangle(const Face& face) const {
    return {to_point(position(face[0])), to_point(position(face[1])), to_point(position(face[2]))};
  }

  // Whether two triangles that share corners meet anywhere else. Two that share an edge do so only when they
  // are folded onto one another, which folds() excludes.
  static bool meet(const Face& a, const Triangle& ta, const Face& b, const Triangle& tb) {
    int shared = 0, at_a = 0, at_b = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        if (a[index(i)] != b[index(j)]) continue;
        ++shared;
        at_a = i;
        at_b = j;
      }
    }
    if (shared >= 2) return false;
    if (shared == 0) return CGAL::do_intersect(ta, tb);
    const Segment opposite_a(ta.vertex(at_a + 1), ta.vertex(at_a + 2));
    const Segment opposite_b(tb.vertex(at_b + 1), tb.vertex(at_b + 2));
    return CGAL::do_intersect(opposite_a, tb) || CGAL::do_intersect(opposite_b, ta);
  }

  bool meets_surface(const Candidate& c, const std::vector<Face>& faces,
                     const std::vector<Triangle>& triangles, const std::vector<int>& around) const {
    for (std::size_t i = 0; i < faces.size(); ++i) {
      for (std::size_t j = i + 1; j < faces.size(); ++j) {
        if (meet(faces[i], triangles[i], faces[j], triangles[j])) return true;
      }
    }
    Eigen::AlignedBox3d box(c.target);
    for (const Face& face : faces) {
      for (const int v : face) box.extend(v == c.u ? c.target : position(v));
    }
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      if (!alive_[f]) continue;
      Eigen::AlignedBox3d other(position(faces_[f][0]));
      other.extend(position(faces_[f][1])).extend(position(faces_[f][2]));
      if (!box.intersects(other)) continue;
      if (std::find(around.begin(), around.end(), static_cast<int>(f)) != around.end()) continue;
      const Triangle neighbour = triangle(faces_[f]);
      for (std::size_t i = 0; i < faces.size(); ++i) {
        if (CGAL::do_overlap(triangles[i].bbox(), neighbour.bbox()) &&
            meet(faces[i], triangles[i], faces_[f], neighbour)) {
          return true;
        }
      }
    }
    return false;
  }

  void collapse(const Candidate& c) {
    for (const int f : star_[index(c.v)]) {
      Face& face = faces_[index(f)];
      if (std::find(face.begin(), face.end(), c.u) != face.end()) {
        alive_[index(f)] = 0;
        for (const int w : face) {
          if (w != c.v) std::erase(star_[index(w)], f);
        }
      } else {
        std::replace(face.begin(), face.end(), c.v, c.u);
        star_[index(c.u)].push_back(f);
      }
    }
    star_[index(c.v)].clear();
    positions_[index(c.u)] = c.target;
    quadrics_[index(c.u)] += quadrics_[index(c.v)];
    ++version_[index(c.u)];
    ++version_[index(c.v)];
    --vertices_;
    for (const int w : neighbours(c.u)) queue_edge(std::min(c.u, w), std::max(c.u, w));
  }

  Obstacle obstacle_;
  double size_;
  std::vector<Vector3d> positions_;
  std::vector<std::vector<int>> star_;  // faces of each vertex; empty when the vertex is gone
  std::vector<int> version_;            // counts the changes of a vertex, so that old candidates are known
  std::vector<Matrix4d> quadrics_;
  std::vector<Face> faces_;
  std::vector<char> alive_;
  int vertices_ = 0;
  std::priority_queue<Candidate> queue_;
};

}  // namespace

TriangleMesh collapse_around(const TriangleMesh& surface, const TriangleMesh& enclosed, int vertices) {
  Collapser collapser(surface, enclosed);
  collapser.run(vertices);
  collapser.tighten(kTightenSweeps);
  return collapser.result();
}

}  // namespace vivify::meshing
