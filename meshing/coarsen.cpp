#include "meshing/coarsen.h"

#include <CGAL/Polygon_mesh_processing/detect_features.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_filter.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include <cmath>
#include <vector>

#include "meshing/cgal_convert.h"

namespace vivify::meshing {

namespace PMP = CGAL::Polygon_mesh_processing;
namespace SMS = CGAL::Surface_mesh_simplification;

TriangleMesh collapse_surface(const TriangleMesh& closed_surface, int vertices) {
  SurfaceMesh surface = to_surface_mesh(closed_surface);
  const auto characteristic = static_cast<long>(surface.number_of_vertices()) +
                              static_cast<long>(surface.number_of_faces()) -
                              static_cast<long>(surface.number_of_edges());
  const long edges = std::max(6L, 3 * (vertices - characteristic));
  using Policies = SMS::GarlandHeckbert_plane_policies<SurfaceMesh, Kernel>;
  const Policies policies(surface);
  SMS::edge_collapse(surface, SMS::Count_stop_predicate<SurfaceMesh>(static_cast<std::size_t>(edges)),
                     CGAL::parameters::get_cost(policies.get_cost())
                         .get_placement(policies.get_placement())
                         .filter(SMS::Bounded_normal_change_filter<>()));
  surface.collect_garbage();
  return from_surface_mesh(surface);
}

TriangleMesh remesh_surface(const TriangleMesh& closed_surface, double edge_length, double sharp_angle) {
  SurfaceMesh surface = to_surface_mesh(closed_surface);
  auto sharp = surface.add_property_map<SurfaceMesh::Edge_index, bool>("e:sharp", false).first;
  PMP::detect_sharp_edges(surface, sharp_angle, sharp);
  std::vector<SurfaceMesh::Edge_index> creases;
  for (const auto edge : surface.edges()) {
    if (sharp[edge]) creases.push_back(edge);
  }
  PMP::split_long_edges(creases, edge_length, surface, CGAL::parameters::edge_is_constrained_map(sharp));
  PMP::isotropic_remeshing(faces(surface), edge_length, surface,
                           CGAL::parameters::number_of_iterations(5)
                               .number_of_relaxation_steps(3)
                               .protect_constraints(true)
                               .edge_is_constrained_map(sharp));
  surface.collect_garbage();
  return from_surface_mesh(surface);
}

TriangleMesh remesh_shell(const TriangleMesh& input, double edge_length, double sharp_angle) {
  SurfaceMesh surface = to_surface_mesh(input);
  auto kept = surface.add_property_map<SurfaceMesh::Edge_index, bool>("e:kept", false).first;
  auto corner = surface.add_property_map<SurfaceMesh::Vertex_index, bool>("v:corner", false).first;
  PMP::detect_sharp_edges(surface, sharp_angle, kept);
  for (const auto edge : surface.edges()) kept[edge] = kept[edge] || surface.is_border(edge);
  for (const auto vertex : surface.vertices()) {
    std::vector<Kernel::Vector_3> rays;
    for (const auto halfedge : surface.halfedges_around_target(surface.halfedge(vertex))) {
      if (!kept[surface.edge(halfedge)]) continue;
      const Kernel::Vector_3 ray = surface.point(surface.source(halfedge)) - surface.point(vertex);
      rays.push_back(ray / std::sqrt(ray.squared_length()));
    }
    // A line that goes straight on through the vertex has opposite rays.
    constexpr double kStraight = -0.866;  // cosine of 180 - 30 degrees
    corner[vertex] = !rays.empty() && (rays.size() != 2 || rays[0] * rays[1] > kStraight);
  }
  PMP::isotropic_remeshing(faces(surface), edge_length, surface,
                           CGAL::parameters::number_of_iterations(5)
                               .number_of_relaxation_steps(3)
                               .edge_is_constrained_map(kept)
                               .vertex_is_constrained_map(corner));
  surface.collect_garbage();
  return from_surface_mesh(surface);
}

bool intersects_itself(const TriangleMesh& surface) {
  return PMP::does_self_intersect(to_surface_mesh(surface));
}

}  // namespace vivify::meshing
