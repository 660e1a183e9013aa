#include "meshing/improve.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <vector>

namespace vivify::meshing {
namespace {

using Vector = Eigen::Vector3d;
using Tet = std::array<int, 4>;

constexpr int kMaxRing = 8;
constexpr double kGain = 1e-4;  // a step counts when the worst sine grows by this
constexpr double kCreaseShare =
    0.12;                          // eigenvalue of the normals, relative to the largest, that makes a crease
constexpr double kMaxTurn = 0.85;  // cosine: a boundary triangle may turn by this when its vertex slides
constexpr double kFirstStep = 0.25;  // of the mean edge length at a vertex
constexpr double kLeash = 0.3;       // of the mean edge: how far a boundary vertex off the surface may go
constexpr int kHalvings = 4;
constexpr int kFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};  // outward, opposite corner k

// Smallest sine of the six dihedral angles; negative for an inverted tetrahedron.
double min_sine(const Vector& a, const Vector& b, const Vector& c, const Vector& d) {
  const Vector ab = b - a, ac = c - a, ad = d - a, bc = c - b, bd = d - b, cd = d - c;
  const double six_volumes = ab.dot(ac.cross(ad));
  // Twice the areas of the faces opposite a, b, c, d.
  const double fa = bc.cross(bd).norm(), fb = ac.cross(ad).norm(), fc = ab.cross(ad).norm(),
               fd = ab.cross(ac).norm();
  const double smallest = std::min({ab.norm() / (fc * fd), ac.norm() / (fb * fd), ad.norm() / (fb * fc),
                                    bc.norm() / (fa * fd), bd.norm() / (fa * fc), cd.norm() / (fa * fb)});
  const double largest = std::max({ab.norm() / (fc * fd), ac.norm() / (fb * fd), ad.norm() / (fb * fc),
                                   bc.norm() / (fa * fd), bd.norm() / (fa * fc), cd.norm() / (fa * fb)});
  const double sine = six_volumes * (six_volumes > 0 ? smallest : largest);
  return std::isfinite(sine) ? sine : -1;
}

class Improver {
 public:
  Improver(TetMesh& mesh, const ClosestPoint& surface, const ImproveSettings& settings)
      : mesh_(mesh),
        surface_(surface),
        settings_(settings),
        goal_(std::sin(settings.wanted_angle * std::numbers::pi / 180)) {
    tets_.resize(static_cast<std::size_t>(mesh.T.rows()));
    at_.resize(static_cast<std::size_t>(mesh.V.rows()));
    for (int t = 0; t < static_cast<int>(tets_.size()); ++t) {
      for (int k = 0; k < 4; ++k) {
        tets_[idx(t)][idx(k)] = mesh.T(t, k);
        at_[idx(mesh.T(t, k))].push_back(t);
      }
    }
    floor_ = mesh.V.col(1).minCoeff();
    home_ = mesh.V;
    sine_.resize(tets_.size());
    for (std::size_t t = 0; t < tets_.size(); ++t) sine_[t] = sine_of(tets_[t]);
    on_surface_.resize(at_.size());
    for (int v = 0; v < static_cast<int>(at_.size()); ++v) {
      on_surface_[idx(v)] = surface_(x(v)).distance <= settings.surface_tolerance;
    }
  }

  void run() {
    for (int pass = 0; pass < settings_.passes; ++pass) {
      bool changed = false;
      for (const int t : worst_first()) {
        if (removed(t) || sine_[idx(t)] >= goal_) continue;
        if (exchange(t)) {
          changed = true;
          continue;
        }
        const Tet corners = tets_[idx(t)];
        for (const int v : corners) changed = move_vertex(v) || changed;
      }
      if (!changed) break;
    }
    mesh_.T.resize(static_cast<Eigen::Index>(
                       std::count_if(tets_.begin(), tets_.end(), [](const Tet& t) { return t[0] >= 0; })),
                   4);
    Eigen::Index row = 0;
    for (const Tet& t : tets_) {
      if (t[0] >= 0) mesh_.T.row(row++) << t[0], t[1], t[2], t[3];
    }
  }

 private:
  static std::size_t idx(int i) { return static_cast<std::size_t>(i); }
  Vector x(int v) const { return mesh_.V.row(v); }
  double sine_of(const Tet& t) const { return min_sine(x(t[0]), x(t[1]), x(t[2]), x(t[3])); }
  double six_volumes(int a, int b, int c, int d) const {
    return (x(b) - x(a)).dot((x(c) - x(a)).cross(x(d) - x(a)));
  }
  bool removed(int t) const { return tets_[idx(t)][0] < 0; }
  static bool has(const Tet& t, int v) { return std::find(t.begin(), t.end(), v) != t.end(); }

  std::vector<int> worst_first() const {
    std::vector<int> order;
    for (int t = 0; t < static_cast<int>(tets_.size()); ++t) {
      if (!removed(t) && sine_[idx(t)] < goal_) order.push_back(t);
    }
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return sine_[idx(a)] < sine_[idx(b)]; });
    return order;
  }

  void remove(int t) {
    for (const int v : tets_[idx(t)]) std::erase(at_[idx(v)], t);
    tets_[idx(t)] = {-1, -1, -1, -1};
  }

  void add(const Tet& tet) {
    const auto t = static_cast<int>(tets_.size());
    tets_.push_back(tet);
    sine_.push_back(sine_of(tet));
    for (const int v : tet) at_[idx(v)].push_back(t);
  }

  bool exchange(int t) {
    const Tet tet = tets_[idx(t)];
    for (int i = 0; i < 4; ++i) {
      for (int j = i + 1; j < 4; ++j) {
        if (remove_edge(tet[idx(i)], tet[idx(j)])) return true;
      }
    }
    for (int k = 0; k < 4; ++k) {
      if (remove_face(t, k)) return true;
    }
    return false;
  }

  // The other tetrahedron at the face (a, b, c) of t; −1 on the boundary.
  int neighbour(int t, int a, int b, int c) const {
    for (const int other : at_[idx(a)]) {
      if (other != t && has(tets_[idx(other)], b) && has(tets_[idx(other)], c)) return other;
    }
    return -1;
  }

  // Two tetrahedra at a face become three at a new edge.
  bool remove_face(int t, int k) {
    const Tet tet = tets_[idx(t)];
    const int a = tet[idx(kFaces[k][0])], b = tet[idx(kFaces[k][1])], c = tet[idx(kFaces[k][2])],
              d = tet[idx(k)];
    const int other = neighbour(t, a, b, c);
    if (other < 0) return false;
    int e = -1;
    for (const int v : tets_[idx(other)]) {
      if (v != a && v != b && v != c) e = v;
    }
    const std::array<Tet, 3> made = {Tet{d, e, a, b}, Tet{d, e, b, c}, Tet{d, e, c, a}};
    double worst = 2;
    for (const Tet& m : made) worst = std::min(worst, sine_of(m));
    if (worst <= std::min(sine_[idx(t)], sine_[idx(other)]) + kGain) return false;
    remove(t);
    remove(other);
    for (const Tet& m : made) add(m);
    return true;
  }

  // The vertices round the edge ab, in the order in which (a, b, r0, r1) is positive. `open`: ab lies on the
  // boundary.
  bool find_ring(int a, int b, std::vector<int>& ring, std::vector<int>& tets, bool& open) const {
    std::map<int, std::pair<int, int>> next;  // ring vertex -> (next ring vertex, tetrahedron)
    std::set<int> targets;
    for (const int t : at_[idx(a)]) {
      const Tet& tet = tets_[idx(t)];
      if (!has(tet, b)) continue;
      std::array<int, 2> rest = {};
      int n = 0;
      for (const int v : tet) {
        if (v != a && v != b) rest[idx(n++)] = v;
      }
      if (six_volumes(a, b, rest[0], rest[1]) < 0) std::swap(rest[0], rest[1]);
      if (!next.emplace(rest[0], std::make_pair(rest[1], t)).second) return false;
      targets.insert(rest[1]);
    }
    if (next.size() > kMaxRing) return false;
    std::vector<int> starts;
    for (const auto& [from, to] : next) {
      if (!targets.contains(from)) starts.push_back(from);
    }
    if (starts.size() > 1) return false;
    open = !starts.empty();
    int v = open ? starts[0] : next.begin()->first;
    ring = {v};
    while (next.contains(v)) {
      tets.push_back(next.at(v).second);
      v = next.at(v).first;
      if (v == ring.front()) break;
      ring.push_back(v);
      if (ring.size() > kMaxRing + 1) return false;
    }
    return tets.size() == next.size();
  }

  bool share_edge(int a, int b) const {
    return std::any_of(at_[idx(a)].begin(), at_[idx(a)].end(), [&](int t) { return has(tets_[idx(t)], b); });
  }

  // Is the edge ab on the boundary?
  bool boundary_edge(int a, int b) const {
    std::vector<int> ring, tets;
    bool open = true;
    return !find_ring(a, b, ring, tets, open) || open;
  }

  // May the boundary edge ab between the triangles (a, b, p) and (a, b, q) become the edge pq?
  bool may_flip_boundary(int a, int b, int p, int q, bool peel) const {
    if (peel ? boundary_edge(p, q) : share_edge(p, q)) return false;
    const Vector n0 = (x(b) - x(a)).cross(x(p) - x(a)), n1 = (x(q) - x(a)).cross(x(b) - x(a));
    const Vector m0 = (x(q) - x(p)).cross(x(a) - x(p)), m1 = (x(b) - x(p)).cross(x(q) - x(p));
    const double area = std::max({n0.norm(), n1.norm(), m0.norm(), m1.norm()});
    const double height = std::abs(six_volumes(a, b, p, q)) / area;
    if (height > settings_.surface_tolerance) return false;
    const double turn = n0.dot(n1) / (n0.norm() * n1.norm()), turned = m0.dot(m1) / (m0.norm() * m1.norm());
    return turn > 0.5 && turned > 0.5;
  }

  // Replaces the tetrahedra round the edge ab by the best ones without it (Klincsek's dynamic programme).
  bool remove_edge(int a, int b) {
    std::vector<int> ring, old;
    bool open = false;
    if (!find_ring(a, b, ring, old, open)) return false;
    const auto n = static_cast<int>(ring.size());
    if (n < (open ? 2 : 3)) return false;
    if (open && !may_flip_boundary(a, b, ring.front(), ring.back(), n == 2)) return false;
    double worst_old = 2;
    for (const int t : old) worst_old = std::min(worst_old, sine_[idx(t)]);

    std::array<std::array<double, kMaxRing + 1>, kMaxRing + 1> best = {};
    std::array<std::array<int, kMaxRing + 1>, kMaxRing + 1> middle = {};
    for (int i = n - 1; i >= 0; --i) {
      best[idx(i)][idx(std::min(i + 1, n - 1))] = 2;
      for (int j = i + 2; j < n; ++j) {
        best[idx(i)][idx(j)] = -2;
        for (int k = i + 1; k < j; ++k) {
          const double here =
              std::min({sine_of({ring[idx(i)], ring[idx(k)], ring[idx(j)], b}),
                        sine_of({a, ring[idx(i)], ring[idx(k)], ring[idx(j)]}),
                        k - i > 1 ? best[idx(i)][idx(k)] : 2.0, j - k > 1 ? best[idx(k)][idx(j)] : 2.0});
          if (here > best[idx(i)][idx(j)]) {
            best[idx(i)][idx(j)] = here;
            middle[idx(i)][idx(j)] = k;
          }
        }
      }
    }
    if (n > 2 && best[0][idx(n - 1)] <= worst_old + kGain) return false;
    if (n == 2 && worst_old >= 0.5 * goal_) return false;  // peeling gives up volume: only for slivers
    if (n == 2 && at_[idx(a)].size() < 2) return false;
    if (n == 2 && at_[idx(b)].size() < 2) return false;
    for (const int t : old) remove(t);
    std::vector<std::pair<int, int>> spans = {{0, n - 1}};
    while (!spans.empty()) {
      const auto [i, j] = spans.back();
      spans.pop_back();
      if (j - i < 2) continue;
      const int k = middle[idx(i)][idx(j)];
      add({ring[idx(i)], ring[idx(k)], ring[idx(j)], b});
      add({a, ring[idx(i)], ring[idx(k)], ring[idx(j)]});
      spans.emplace_back(i, k);
      spans.emplace_back(k, j);
    }
    return true;
  }

  // Boundary triangles at v, outward.
  std::vector<std::array<int, 3>> boundary_at(int v) const {
    std::vector<std::array<int, 3>> faces;
    for (const int t : at_[idx(v)]) {
      const Tet& tet = tets_[idx(t)];
      for (int k = 0; k < 4; ++k) {
        if (tet[idx(k)] == v) continue;
        const std::array<int, 3> face = {tet[idx(kFaces[k][0])], tet[idx(kFaces[k][1])],
                                         tet[idx(kFaces[k][2])]};
        if (neighbour(t, face[0], face[1], face[2]) < 0) faces.push_back(face);
      }
    }
    return faces;
  }

  Vector normal(const std::array<int, 3>& f) const { return (x(f[1]) - x(f[0])).cross(x(f[2]) - x(f[0])); }

  // Directions in which v may move: three inside, two on a smooth boundary, one on a crease, none at a
  // corner.
  std::vector<Vector> free_directions(const std::vector<std::array<int, 3>>& faces) const {
    if (faces.empty()) return {Vector::UnitX(), Vector::UnitY(), Vector::UnitZ()};
    Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero();
    for (const auto& face : faces) {
      const Vector n = normal(face);
      if (n.norm() > 0) tensor += n * n.transpose() / n.norm();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(tensor);
    std::vector<Vector> directions;
    for (int k = 0; k < 2; ++k) {
      if (solver.eigenvalues()[k] < kCreaseShare * solver.eigenvalues()[2])
        directions.emplace_back(solver.eigenvectors().col(k));
    }
    return directions;
  }

  static std::vector<Vector> search_directions(const std::vector<Vector>& free) {
    std::vector<Vector> directions;
    const auto n = static_cast<int>(free.size());
    const int combinations = n == 0 ? 0 : static_cast<int>(std::lround(std::pow(3, n)));
    for (int code = 0; code < combinations; ++code) {
      Vector d = Vector::Zero();
      for (int k = 0, rest = code; k < n; ++k, rest /= 3) d += (rest % 3 - 1) * free[idx(k)];
      if (d.norm() > 0.5) directions.push_back(d.normalized());
    }
    return directions;
  }

  double worst_at(int v) const {
    double worst = 2;
    for (const int t : at_[idx(v)]) worst = std::min(worst, sine_of(tets_[idx(t)]));
    return worst;
  }

  bool move_vertex(int v) {
    const auto faces = boundary_at(v);
    const bool on_floor = settings_.keep_floor && mesh_.V(v, 1) <= floor_;
    std::vector<Vector> free = free_directions(faces);
    if (on_floor) {
      for (Vector& direction : free) direction.y() = 0;
    }
    const std::vector<Vector> directions = search_directions(free);
    if (directions.empty()) return false;
    std::vector<Vector> normals;
    for (const auto& face : faces) normals.push_back(normal(face).normalized());
    double step = 0;
    int edges = 0;
    for (const int t : at_[idx(v)]) {
      for (const int u : tets_[idx(t)]) {
        if (u == v) continue;
        step += (x(u) - x(v)).norm();
        ++edges;
      }
    }
    const double leash = kLeash * step / edges;
    step *= kFirstStep / edges;
    const Vector start = x(v);
    Vector best_place = start;
    const double before = worst_at(v);
    double best = before;
    for (int halving = 0; halving < kHalvings; ++halving, step /= 2) {
      const Vector origin = best_place;
      for (const Vector& direction : directions) {
        Vector place = origin + step * direction;
        if (!faces.empty() && on_surface_[idx(v)]) {
          const ClosestPoint::Hit hit = surface_(place);
          if (hit.distance > step) continue;
          place = hit.point;
        }
        if (on_floor) place.y() = floor_;
        if (!faces.empty() && !on_surface_[idx(v)] && (place - home_.row(v).transpose()).norm() > leash)
          continue;
        mesh_.V.row(v) = place;
        bool turned = false;
        for (std::size_t f = 0; f < faces.size() && !turned; ++f)
          turned = normal(faces[f]).normalized().dot(normals[f]) < kMaxTurn;
        if (turned) continue;
        const double worst = worst_at(v);
        if (worst > best + kGain) {
          best = worst;
          best_place = place;
        }
      }
    }
    mesh_.V.row(v) = best_place;
    if (!(best > before)) return false;
    for (const int t : at_[idx(v)]) sine_[idx(t)] = sine_of(tets_[idx(t)]);
    return true;
  }

  TetMesh& mesh_;
  const ClosestPoint& surface_;
  const ImproveSettings& settings_;
  double goal_;
  double floor_ = 0;
  Points home_;  // where the vertices were at the start
  std::vector<Tet> tets_;
  std::vector<double> sine_;
  std::vector<std::vector<int>> at_;  // tetrahedra of each vertex
  std::vector<char> on_surface_;
};

}  // namespace

void improve_tetrahedra(TetMesh& mesh, const ClosestPoint& surface, const ImproveSettings& settings) {
  Improver(mesh, surface, settings).run();
}

}  // namespace vivify::meshing
