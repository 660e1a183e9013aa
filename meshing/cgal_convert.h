// Surfaces to and from CGAL. Only for the translation units of vivify_meshing_cgal.
#pragma once

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include <array>
#include <vector>

#include "common/mesh.h"

namespace vivify::meshing {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using SurfaceMesh = CGAL::Surface_mesh<Point>;

inline std::vector<Point> to_cgal_points(const Points& V) {
  std::vector<Point> points;
  points.reserve(static_cast<std::size_t>(V.rows()));
  for (Eigen::Index v = 0; v < V.rows(); ++v) points.emplace_back(V(v, 0), V(v, 1), V(v, 2));
  return points;
}

inline std::vector<std::array<std::size_t, 3>> to_cgal_triangles(const Triangles& F) {
  std::vector<std::array<std::size_t, 3>> triangles;
  triangles.reserve(static_cast<std::size_t>(F.rows()));
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    triangles.push_back({static_cast<std::size_t>(F(f, 0)), static_cast<std::size_t>(F(f, 1)),
                         static_cast<std::size_t>(F(f, 2))});
  }
  return triangles;
}

// Faces that would make the surface non-manifold are left out.
inline SurfaceMesh to_surface_mesh(const TriangleMesh& mesh) {
  SurfaceMesh surface;
  for (const Point& point : to_cgal_points(mesh.V)) surface.add_vertex(point);
  for (const auto& [a, b, c] : to_cgal_triangles(mesh.F)) {
    surface.add_face(SurfaceMesh::Vertex_index(static_cast<SurfaceMesh::size_type>(a)),
                     SurfaceMesh::Vertex_index(static_cast<SurfaceMesh::size_type>(b)),
                     SurfaceMesh::Vertex_index(static_cast<SurfaceMesh::size_type>(c)));
  }
  return surface;
}

// Vertices of no face are left out.
inline TriangleMesh from_surface_mesh(const SurfaceMesh& surface) {
  TriangleMesh mesh;
  std::vector<int> index(surface.num_vertices() + surface.number_of_removed_vertices(), -1);
  std::vector<Point> points;
  mesh.F.resize(static_cast<Eigen::Index>(surface.number_of_faces()), 3);
  Eigen::Index row = 0;
  for (const auto face : surface.faces()) {
    int corner = 0;
    for (const auto vertex : surface.vertices_around_face(surface.halfedge(face))) {
      int& id = index[vertex.idx()];
      if (id < 0) {
        id = static_cast<int>(points.size());
        points.push_back(surface.point(vertex));
      }
      mesh.F(row, corner++) = id;
    }
    ++row;
  }
  mesh.V.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t v = 0; v < points.size(); ++v) {
    mesh.V.row(static_cast<Eigen::Index>(v)) << points[v].x(), points[v].y(), points[v].z();
  }
  return mesh;
}

}  // namespace vivify::meshing
