#include "meshing/refine_plane.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_size_criteria_2.h>
#include <CGAL/Delaunay_mesh_vertex_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "common/error.h"

namespace vivify::meshing {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Structure = CGAL::Triangulation_data_structure_2<CGAL::Delaunay_mesh_vertex_base_2<Kernel>,
                                                       CGAL::Delaunay_mesh_face_base_2<Kernel>>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure, CGAL::Exact_predicates_tag>;
using Criteria = CGAL::Delaunay_mesh_size_criteria_2<Triangulation>;
using Mesher = CGAL::Delaunay_mesher_2<Triangulation, Criteria>;

// Marks the faces that an odd number of segments separates from the outside.
void mark_inside(Triangulation& triangulation) {
  std::map<Triangulation::Face_handle, int> depth;
  std::vector<Triangulation::Face_handle> layer = {triangulation.infinite_face()}, next;
  for (int level = 0; !layer.empty(); ++level, layer.swap(next), next.clear()) {
    while (!layer.empty()) {
      const Triangulation::Face_handle face = layer.back();
      layer.pop_back();
      if (!depth.emplace(face, level).second) continue;
      face->set_in_domain(level % 2 == 1);
      for (int k = 0; k < 3; ++k) {
        (face->is_constrained(k) ? next : layer).push_back(face->neighbor(k));
      }
    }
  }
}

}  // namespace

std::optional<PlaneTriangles> refine_plane(const Points2& points, const Edges& segments,
                                           const RefineSettings& settings) {
  Triangulation triangulation;
  std::vector<Triangulation::Vertex_handle> given;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const auto near = given.empty() ? Triangulation::Face_handle() : given.back()->face();
    given.push_back(triangulation.insert(Kernel::Point_2(points(i, 0), points(i, 1)), near));
  }
  for (Eigen::Index s = 0; s < segments.rows(); ++s) {
    const auto a = given[static_cast<std::size_t>(segments(s, 0))],
               b = given[static_cast<std::size_t>(segments(s, 1))];
    if (a != b) triangulation.insert_constraint(a, b);
  }
  const auto limit = static_cast<std::size_t>(settings.most_vertices);
  if (triangulation.dimension() == 2) {
    mark_inside(triangulation);
    Mesher mesher(triangulation, Criteria(settings.least_sine_squared, settings.longest_edge));
    mesher.init(true);
    while (!mesher.is_refinement_done()) {
      if (triangulation.number_of_vertices() > limit) return std::nullopt;
      mesher.step_by_step_refine_mesh();
    }
  }

  PlaneTriangles result;
  std::map<Triangulation::Vertex_handle, int> index;
  std::vector<std::pair<double, double>> coordinates;
  const auto add = [&](Triangulation::Vertex_handle vertex) {
    const auto [it, inserted] = index.emplace(vertex, static_cast<int>(coordinates.size()));
    if (inserted) coordinates.emplace_back(vertex->point().x(), vertex->point().y());
    return it->second;
  };
  result.point.resize(points.rows());
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    result.point[i] = add(given[static_cast<std::size_t>(i)]);
  }
  std::vector<Triangulation::Vertex_handle> others;
  for (const auto vertex : triangulation.finite_vertex_handles()) {
    if (!index.contains(vertex)) others.push_back(vertex);
  }
  std::sort(others.begin(), others.end(), [](auto a, auto b) { return a->point() < b->point(); });
  for (const auto vertex : others) add(vertex);
  result.V.resize(static_cast<Eigen::Index>(coordinates.size()), 2);
  for (std::size_t v = 0; v < coordinates.size(); ++v) {
    result.V.row(static_cast<Eigen::Index>(v)) << coordinates[v].first, coordinates[v].second;
  }
  std::vector<std::array<int, 3>> faces;
  for (const auto face : triangulation.finite_face_handles()) {
    if (!face->is_in_domain()) continue;
    std::array<int, 3> corners = {add(face->vertex(0)), add(face->vertex(1)), add(face->vertex(2))};
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    faces.push_back(corners);
  }
  if (faces.empty()) throw Error(ErrorKind::geometry, "the segments bound no area", "close the outline");
  std::sort(faces.begin(), faces.end());
  result.F.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    result.F.row(static_cast<Eigen::Index>(f)) << faces[f][0], faces[f][1], faces[f][2];
  }
  return result;
}

std::optional<PlaneTriangles> refine_plane(const std::vector<Points2>& loops,
                                           const RefineSettings& settings) {
  Eigen::Index count = 0;
  for (const Points2& loop : loops) count += loop.rows();
  if (count > settings.most_vertices) return std::nullopt;
  Points2 points(count, 2);
  Edges segments(count, 2);
  Eigen::Index first = 0;
  for (const Points2& loop : loops) {
    points.middleRows(first, loop.rows()) = loop;
    for (Eigen::Index i = 0; i < loop.rows(); ++i) {
      segments.row(first + i) << static_cast<int>(first + i), static_cast<int>(first + (i + 1) % loop.rows());
    }
    first += loop.rows();
  }
  return refine_plane(points, segments, settings);
}

std::map<int, int> next_on_boundary(const Triangles& F) {
  std::set<std::pair<int, int>> edges;
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) edges.emplace(F(f, k), F(f, (k + 1) % 3));
  }
  std::map<int, int> next;
  for (const auto& [a, b] : edges) {
    if (!edges.contains({b, a})) next[a] = b;
  }
  return next;
}

}  // namespace vivify::meshing
