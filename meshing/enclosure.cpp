#include "meshing/enclosure.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/error.h"
#include "common/parallel.h"
#include "common/text.h"

namespace vivify::meshing {

Eigen::Vector3d closest_on_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                    const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  // By Voronoi region of corners, edges and face (Ericson, Real-Time Collision Detection, 5.1.5).
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  return a + (vb * ab + vc * ac) / (va + vb + vc);
}

double winding_number(const TriangleMesh& surface, const Eigen::Vector3d& p) {
  double half_angles = 0;
  for (Eigen::Index f = 0; f < surface.F.rows(); ++f) {
    const Eigen::Vector3d a = surface.V.row(surface.F(f, 0)).transpose() - p;
    const Eigen::Vector3d b = surface.V.row(surface.F(f, 1)).transpose() - p;
    const Eigen::Vector3d c = surface.V.row(surface.F(f, 2)).transpose() - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    half_angles +=
        std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return half_angles / (2 * std::numbers::pi);
}

double distance_to(const TriangleMesh& surface, const Eigen::Vector3d& p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (Eigen::Index f = 0; f < surface.F.rows(); ++f) {
    const Eigen::Vector3d q = closest_on_triangle(
        p, surface.V.row(surface.F(f, 0)), surface.V.row(surface.F(f, 1)), surface.V.row(surface.F(f, 2)));
    nearest = std::min(nearest, (q - p).squaredNorm());
  }
  return std::sqrt(nearest);
}

std::vector<int> points_not_inside(const TriangleMesh& surface, const Points& points, double clearance) {
  std::vector<char> bad(static_cast<std::size_t>(points.rows()), 0);
  constexpr std::size_t kChunk = 64;
  parallel_for((bad.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
    for (std::size_t i = chunk * kChunk; i < std::min(bad.size(), (chunk + 1) * kChunk); ++i) {
      const Eigen::Vector3d p = points.row(static_cast<Eigen::Index>(i));
      bad[i] = !(winding_number(surface, p) > 0.5 && distance_to(surface, p) > clearance);
    }
  });
  std::vector<int> indices;
  for (std::size_t i = 0; i < bad.size(); ++i) {
    if (bad[i]) indices.push_back(static_cast<int>(i));
  }
  return indices;
}

std::string list_some(const std::string& what, const std::vector<int>& indices) {
  constexpr std::size_t kShown = 5;
  std::vector<std::string> words;
  for (std::size_t i = 0; i < std::min(kShown, indices.size()); ++i)
    words.push_back(std::to_string(indices[i]));
  if (indices.size() <= kShown) return what + " " + join_words(words);
  std::string text = what + " ";
  for (const std::string& word : words) text += word + ", ";
  text.resize(text.size() - 2);
  return text + " and " + std::to_string(indices.size() - kShown) + " more";
}

void require_enclosed(const std::string& name, const RowMatrixXd& points, double clearance,
                      const std::function<std::vector<int>(double)>& not_inside) {
  const auto fail = [&](const std::string& problem, const std::string& hint) {
    throw Error(ErrorKind::geometry, name + " cannot be used: " + problem, hint);
  };
  const std::vector<int> outside = not_inside(0);
  if (!outside.empty()) {
    std::string place;
    for (const double coordinate : points.row(outside[0])) {
      place += (place.empty() ? "(" : ", ") + number_text(coordinate);
    }
    fail(std::to_string(outside.size()) + " of " + std::to_string(points.rows()) +
             " vertices of the character are not strictly inside: " + list_some("vertices", outside) +
             ", vertex " + std::to_string(outside[0]) + " at " + place + ")",
         "enlarge the cage there");
  }
  if (!(clearance > 0)) return;
  const std::vector<int> close = not_inside(clearance);
  if (!close.empty()) {
    fail(std::to_string(close.size()) + " vertices of the character are nearer to it than " +
             number_text(clearance) + " m: " + list_some("vertices", close),
         "enlarge the cage there, or ask for less clearance");
  }
}

}  // namespace vivify::meshing
