#include "meshing/planar_cage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "common/error.h"
#include "common/log.h"
#include "common/text.h"
#include "meshing/enclosure.h"
#include "meshing/polyline.h"
#include "meshing/tapered_box.h"

namespace vivify::meshing {
namespace {

// The outline is moved a little farther than the clearance, which leaves room for chords of its round
// corners.
constexpr double kRoom = 1.05;
constexpr double kRoundness = 0.02;  // of the round corners, over the clearance

// A vertex that saves less area than this, over the clearance squared, is better spent elsewhere.
constexpr double kWorthAVertex = 0.5;

std::vector<Points2> outer_loops(std::vector<Points2> loops) {
  std::erase_if(loops, [](const Points2& loop) { return signed_area(loop) < 0; });
  return loops;
}

// One loop around the outline and the points at the given distance from them; gaps between parts are closed
// as far as that is needed.
Points2 loop_around(const Points2& points, const Outline& outline, double distance, double size) {
  std::vector<Points2> parts = outer_loops(outline.loops);
  const double dot = 1e-6 * size;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Eigen::RowVector2d p = points.row(i);
    if (winding_number(parts, p.transpose()) > 0) continue;
    Points2 diamond(4, 2);
    diamond << p.x() - dot, p.y(), p.x(), p.y() - dot, p.x() + dot, p.y(), p.x(), p.y() + dot;
    parts.push_back(diamond);
  }
  const double tolerance = kRoundness * distance;
  std::vector<Points2> loops = outer_loops(offset(parts, kRoom * distance, tolerance));
  for (double closing = distance; loops.size() > 1 && closing < 2 * size; closing *= 1.5) {
    loops = outer_loops(
        offset(outer_loops(offset(parts, kRoom * distance + closing, tolerance)), -closing, tolerance));
  }
  if (loops.size() != 1) {
    throw Error(ErrorKind::geometry, "no connected cage could be made around the character",
                "give a cage, or ask for 4 vertices");
  }
  return loops[0];
}

// Fills up a simple counter-clockwise polygon from outside until few vertices are left.
class Simplifier {
 public:
  explicit Simplifier(const Points2& loop) {
    for (Eigen::Index i = 0; i < loop.rows(); ++i) corners_.emplace_back(loop.row(i));
  }

  // Until `wanted` vertices are left, and further while a step adds no more than `spare` m².
  void reduce_to(std::size_t wanted, double spare) {
    while (reduce(corners_.size() > wanted ? std::numeric_limits<double>::infinity() : spare)) {
    }
  }

  // Cuts the edges into pieces, the longest first.
  void refine_to(std::size_t wanted) {
    std::vector<double> lengths;
    for (std::size_t i = 0; i < corners_.size(); ++i) lengths.push_back((at(i + 1) - at(i)).norm());
    const std::vector<int> pieces = share_pieces(lengths, static_cast<int>(wanted));
    std::vector<Eigen::Vector2d> refined;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      for (int k = 0; k < pieces[i]; ++k) refined.push_back(at(i) + (at(i + 1) - at(i)) * k / pieces[i]);
    }
    corners_ = std::move(refined);
  }

  Points2 polygon() const {
    Points2 points(std::ssize(corners_), 2);
    for (std::size_t i = 0; i < corners_.size(); ++i) points.row(static_cast<Eigen::Index>(i)) = corners_[i];
    return points;
  }

 private:
  // One vertex less: vertex `first` leaves out a notch, or an edge between vertices `first` and first + 1
  // shrinks to `tip`, where its neighbours meet.
  struct Step {
    double area;
    std::size_t first;
    std::optional<Eigen::Vector2d> tip;
  };

  const Eigen::Vector2d& at(std::size_t i) const { return corners_[i % corners_.size()]; }

  double turn(std::size_t i) const {
    const std::size_t n = corners_.size();
    return cross2(at(i) - at(i + n - 1), at(i + 1) - at(i));
  }

  std::vector<Step> steps() const {
    std::vector<Step> result;
    const std::size_t n = corners_.size();
    for (std::size_t i = 0; i < n; ++i) {
      const double here = turn(i);
      if (here <= 0) {
        result.push_back({-here / 2, i, std::nullopt});
        continue;
      }
      if (!(turn(i + 1) > 0)) continue;
      const Eigen::Vector2d a = at(i), b = at(i + 1), u = a - at(i + n - 1), v = b - at(i + 2);
      const double sine = cross2(u, v);
      if (!(sine < 0)) continue;  // the neighbours do not meet on this side
      const Eigen::Vector2d tip = a + u * (cross2(b - a, v) / sine);
      result.push_back({std::abs(cross2(b - a, tip - a)) / 2, i, tip});
    }
    std::stable_sort(result.begin(), result.end(),
                     [](const Step& s, const Step& t) { return s.area < t.area; });
    return result;
  }

  // Whether segment pq meets an edge other than the ones that start at the vertices skip ... skip + count
  // − 1.
  bool blocked(const Eigen::Vector2d& p, const Eigen::Vector2d& q, std::size_t skip,
               std::size_t count) const {
    const std::size_t n = corners_.size();
    for (std::size_t k = count; k < n; ++k) {
      const std::size_t e = skip + k;
      if (segments_meet(p, q, at(e), at(e + 1))) return true;
    }
    return false;
  }

  bool legal(const Step& step) const {
    const std::size_t n = corners_.size(), i = step.first;
    if (step.tip) {  // edges i−1, i and i+1 change
      return !blocked(at(i), *step.tip, i + n - 1, 3) && !blocked(*step.tip, at(i + 1), i + n - 1, 3);
    }
    // Edges i−1 and i go; their neighbours touch the new one in its ends, where it must not fold back.
    const Eigen::Vector2d &before = at(i + n - 1), &after = at(i + 1);
    const auto folds = [](const Eigen::Vector2d& end, const Eigen::Vector2d& one,
                          const Eigen::Vector2d& two) {
      const Eigen::Vector2d u = one - end, v = two - end;
      return cross2(u, v) == 0 && u.dot(v) > 0;
    };
    return n > 4 && !blocked(before, after, i + n - 2, 4) && !folds(before, after, at(i + n - 2)) &&
           !folds(after, before, at(i + 2));
  }

  bool reduce(double most_area) {
    if (corners_.size() <= 3) return false;
    for (const Step& step : steps()) {
      if (step.area > most_area) return false;
      if (!legal(step)) continue;
      const std::size_t n = corners_.size();
      if (step.tip) {
        corners_[step.first] = *step.tip;
        corners_.erase(corners_.begin() + static_cast<std::ptrdiff_t>((step.first + 1) % n));
      } else {
        corners_.erase(corners_.begin() + static_cast<std::ptrdiff_t>(step.first));
      }
      return true;
    }
    return false;
  }

  std::vector<Eigen::Vector2d> corners_;
};

Points2 join(const Points2& points, const std::vector<Points2>& loops) {
  Eigen::Index count = points.rows();
  for (const Points2& loop : loops) count += loop.rows();
  Points2 all(count, 2);
  all.topRows(points.rows()) = points;
  Eigen::Index row = points.rows();
  for (const Points2& loop : loops) {
    all.middleRows(row, loop.rows()) = loop;
    row += loop.rows();
  }
  return all;
}

}  // namespace

Points2 make_planar_cage(const Points2& must_enclose, const Outline& outline, const CageSettings& settings) {
  const Points2 enclosed = join(must_enclose, outline.loops);
  if (enclosed.rows() == 0) throw Error(ErrorKind::geometry, "there is nothing to make a cage around");
  const double size = box_of(enclosed).diagonal().norm();
  const double clearance = settings.clearance * size;
  Points2 cage;
  if (settings.vertices == 4) {
    cage = tapered_rectangle(enclosed, clearance);
  } else {
    Simplifier simplifier(loop_around(must_enclose, outline, clearance, size));
    const auto wanted = static_cast<std::size_t>(std::max(3, settings.vertices));
    simplifier.reduce_to(wanted, kWorthAVertex * clearance * clearance);
    simplifier.refine_to(wanted);
    cage = simplifier.polygon();
  }
  cage = validate_planar_cage(std::move(cage), must_enclose, 0.999 * clearance);
  if (cage.rows() != settings.vertices) {
    log_warning("the cage has " + std::to_string(cage.rows()) + " vertices instead of " +
                std::to_string(settings.vertices) + ": nothing nearer encloses the character");
  }
  log_info("cage: " + std::to_string(cage.rows()) + " vertices, area " + number_text(signed_area(cage)) +
           " m²");
  return cage;
}

Points2 validate_planar_cage(Points2 cage, const Points2& must_enclose, double clearance,
                             const std::string& name) {
  const auto fail = [&](const std::string& problem, const std::string& hint) {
    throw Error(ErrorKind::geometry, name + " cannot be used: " + problem, hint);
  };
  const auto place = [](const Points2& points, Eigen::Index i) {
    return "(" + number_text(points(i, 0)) + ", " + number_text(points(i, 1)) + ")";
  };
  if (cage.rows() < 3) fail("it has fewer than 3 vertices", "give a polygon");
  for (Eigen::Index i = 0; i < cage.rows(); ++i) {
    if (!cage.row(i).allFinite()) fail("vertex " + std::to_string(i) + " is not finite", "repair it");
    if (cage.row(i) == cage.row((i + 1) % cage.rows())) {
      fail("vertices " + std::to_string(i) + " and " + std::to_string((i + 1) % cage.rows()) +
               " are in the same place " + place(cage, i),
           "leave one out");
    }
  }
  const auto [first, second] = meeting_edges({cage});
  if (first >= 0) {
    const auto edge = [&](int e) {
      return std::to_string(e) + "-" + std::to_string((e + 1) % static_cast<int>(cage.rows()));
    };
    fail("it crosses or touches itself: edge " + edge(first) + " meets edge " + edge(second),
         "move its vertices apart there");
  }
  if (signed_area(cage) < 0)
    cage.bottomRows(cage.rows() - 1) = cage.bottomRows(cage.rows() - 1).colwise().reverse().eval();
  require_enclosed(name, must_enclose, clearance,
                   [&](double wanted) { return points_not_inside(cage, must_enclose, wanted); });
  return cage;
}

}  // namespace vivify::meshing
