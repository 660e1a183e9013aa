#include "meshing/rod.h"

#include <algorithm>
#include <vector>

#include "common/error.h"
#include "meshing/polyline.h"

namespace vivify::meshing {
namespace {

Points2 without_repeats(const Points2& points, bool closed) {
  Points2 kept(points.rows(), 2);
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    if (count == 0 || points.row(i) != kept.row(count - 1)) kept.row(count++) = points.row(i);
  }
  while (closed && count > 1 && kept.row(count - 1) == kept.row(0)) --count;
  return kept.topRows(count);
}

}  // namespace

Rod rod_from_polyline(const Points2& polyline, bool closed, int vertices) {
  if (!polyline.allFinite()) {
    throw Error(ErrorKind::geometry, "the polyline of a rod has a point that is not finite", "repair it");
  }
  const Points2 points = without_repeats(polyline, closed);
  if (points.rows() < (closed ? 3 : 2)) {
    throw Error(ErrorKind::geometry, "the polyline of a rod has no length",
                closed ? "give at least 3 different points" : "give at least 2 different points");
  }
  std::vector<int> corners = corners_of(points, closed);
  const int least = std::max(static_cast<int>(corners.size()), closed ? 3 : 2);
  if (vertices < least) {
    throw Error(ErrorKind::geometry,
                "a rod of " + std::to_string(vertices) + " vertices cannot follow a polyline with " +
                    std::to_string(corners.size()) + " corners and ends",
                "ask for at least " + std::to_string(least) + " vertices");
  }
  // Sections between the corners; a smooth closed polyline is one section from its first point on.
  if (corners.empty()) corners.push_back(0);
  std::vector<Points2> sections;
  std::vector<double> lengths;
  const std::size_t count = corners.size() - (closed ? 0 : 1);
  for (std::size_t c = 0; c < count; ++c) {
    sections.push_back(section(points, corners[c], corners[(c + 1) % corners.size()]));
    lengths.push_back(arc_length(sections.back()));
  }
  const std::vector<int> edges = share_pieces(lengths, closed ? vertices : vertices - 1);
  Rod rod;
  rod.V.resize(vertices, 2);
  Eigen::Index row = 0;
  for (std::size_t s = 0; s < sections.size(); ++s) {
    const Points2 part = spread_evenly(sections[s], edges[s]);
    rod.V.middleRows(row, edges[s]) = part.topRows(edges[s]);
    row += edges[s];
  }
  if (!closed) rod.V.row(row) = points.row(points.rows() - 1);
  rod.E.resize(closed ? vertices : vertices - 1, 2);
  for (int e = 0; e < rod.E.rows(); ++e) rod.E.row(e) << e, (e + 1) % vertices;
  return rod;
}

}  // namespace vivify::meshing
