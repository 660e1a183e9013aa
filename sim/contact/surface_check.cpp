#include "sim/contact/surface_check.h"

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "common/error.h"
#include "common/text.h"

namespace vivify::sim {
namespace {

constexpr double kLeastOpening = 0.1;  // of the area of a part: what its holes span when it is open
constexpr double kNoVolume = 1e-9;     // of area^3/2: sheets of two faces enclose nothing

using Edge = std::pair<int, int>;

struct EdgeUse {
  int forward = 0, backward = 0;  // faces that go along it from the lower to the higher vertex, and back
  int count() const { return forward + backward; }
};

// A connected part of the surface.
struct Part {
  double area = 0, volume = 0;
  Eigen::AlignedBox3d box;
  std::vector<Edge> rim;
  bool closed() const { return rim.empty(); }
};

class DisjointSets {
 public:
  explicit DisjointSets(Eigen::Index size) : above_(static_cast<std::size_t>(size)) {
    std::iota(above_.begin(), above_.end(), 0);
  }
  int root(int item) {
    while (above(item) != item) {
      above(item) = above(above(item));
      item = above(item);
    }
    return item;
  }
  void join(int a, int b) { above(root(a)) = root(b); }

 private:
  int& above(int item) { return above_[static_cast<std::size_t>(item)]; }
  std::vector<int> above_;
};

class Check {
 public:
  Check(const std::string& name, const TriangleMesh& surface)
      : name_(name), V_(surface.V), F_(surface.F), part_of_(V_.rows()), hole_of_(V_.rows()) {
    for (int f = 0; f < F_.rows(); ++f) {
      if (collapsed(f)) continue;
      for (int k = 0; k < 3; ++k) {
        const int a = F_(f, k), b = F_(f, (k + 1) % 3);
        EdgeUse& use = edges_[std::minmax(a, b)];
        ++(a < b ? use.forward : use.backward);
        part_of_.join(a, b);
      }
    }
  }

  void run() {
    flipped_faces();
    find_parts();
    for (const auto& [root, part] : parts_) holes(part);
    for (const auto& [root, part] : parts_) inward(part);
  }

 private:
  bool collapsed(int f) const { return F_(f, 0) == F_(f, 1) || F_(f, 1) == F_(f, 2) || F_(f, 2) == F_(f, 0); }
  Eigen::Vector3d at(int vertex) const { return V_.row(vertex).transpose(); }

  static std::string text(const Eigen::Vector3d& p) {
    const auto shown = [](double v) { return number_text(std::round(1e4 * v) / 1e4 + 0.0); };  // no -0
    return "(" + shown(p.x()) + ", " + shown(p.y()) + ", " + shown(p.z()) + ")";
  }
  static std::string edges_text(std::size_t count) {
    return count == 1 ? "1 edge" : std::to_string(count) + " edges";
  }
  std::string place(const Edge& edge) const {
    return "from " + text(at(edge.first)) + " to " + text(at(edge.second));
  }

  [[noreturn]] void fail(const std::string& message, const std::string& hint) const {
    throw Error(ErrorKind::geometry, "collider '" + name_ + "': " + message, hint);
  }

  void flipped_faces() const {
    std::vector<Edge> wrong;
    for (const auto& [edge, use] : edges_) {
      if (use.count() == 2 && use.forward != use.backward) wrong.push_back(edge);
    }
    if (wrong.empty()) return;
    fail("the faces on both sides of " + edges_text(wrong.size()) + " face opposite ways, for example " +
             place(wrong.front()),
         "flip faces until all of them face outward");
  }

  void find_parts() {
    for (int f = 0; f < F_.rows(); ++f) {
      if (collapsed(f)) continue;
      Part& part = parts_[part_of_.root(F_(f, 0))];
      const Eigen::Vector3d a = at(F_(f, 0)), b = at(F_(f, 1)), c = at(F_(f, 2));
      part.area += (b - a).cross(c - a).norm() / 2;
      for (const Eigen::Vector3d& corner : {a, b, c}) part.box.extend(corner);
    }
    // Volumes are taken about a point of the part, so that it may lie anywhere.
    for (int f = 0; f < F_.rows(); ++f) {
      if (collapsed(f)) continue;
      const int first = part_of_.root(F_(f, 0));
      const Eigen::Vector3d a = at(F_(f, 0)) - at(first), b = at(F_(f, 1)) - at(first),
                            c = at(F_(f, 2)) - at(first);
      parts_[first].volume += a.dot(b.cross(c)) / 6;
    }
    for (const auto& [edge, use] : edges_) {
      if (use.count() != 1) continue;
      parts_[part_of_.root(edge.first)].rim.push_back(edge);
      hole_of_.join(edge.first, edge.second);  // edges of one hole hang together
    }
  }

  void holes(const Part& part) {
    if (part.closed()) return;
    struct Hole {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      int edges = 0;
    };
    std::map<int, Hole> holes;
    for (const auto& [a, b] : part.rim) {
      Hole& hole = holes[hole_of_.root(a)];
      hole.sum += (at(a) + at(b)) / 2;
      ++hole.edges;
    }
    double opening = 0;
    for (const auto& [a, b] : part.rim) {
      const Hole& hole = holes.at(hole_of_.root(a));
      const Eigen::Vector3d middle = hole.sum / hole.edges;
      opening += (at(a) - middle).cross(at(b) - middle).norm() / 2;
    }
    if (opening >= kLeastOpening * part.area) return;
    fail((holes.size() == 1 ? "a hole of " : std::to_string(holes.size()) + " holes of ") +
             edges_text(part.rim.size()) + " in a surface that is closed otherwise, for example " +
             place(part.rim.front()),
         "close them; surfaces may be open, but then their openings must span a tenth of their area");
  }

  void inward(const Part& part) const {
    if (!part.closed() || part.volume >= -kNoVolume * std::pow(part.area, 1.5)) return;
    for (const auto& [root, other] : parts_) {
      if (&other != &part && other.closed() && other.volume > 0 && other.box.contains(part.box)) return;
    }
    fail("its surface is closed and faces inward, for example at " + text(part.box.center()),
         "flip its faces");
  }

  const std::string& name_;
  const Points& V_;
  const Triangles& F_;
  DisjointSets part_of_, hole_of_;  // of vertices
  std::map<Edge, EdgeUse> edges_;
  std::map<int, Part> parts_;
};

}  // namespace

void check_collider_surface(const std::string& name, const TriangleMesh& surface) {
  Check(name, surface).run();
}

}  // namespace vivify::sim
