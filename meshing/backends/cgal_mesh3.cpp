#include "meshing/backends/cgal_mesh3.h"

#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Polyhedral_mesh_domain_3.h>
#include <CGAL/make_mesh_3.h>

#include <map>

#include "meshing/cgal_convert.h"

namespace vivify::meshing {

TetMesh mesh_with_cgal(const TriangleMesh& closed_surface, double size) {
  using Domain = CGAL::Polyhedral_mesh_domain_3<SurfaceMesh, Kernel>;
  using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
  using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;
  using Criteria = CGAL::Mesh_criteria_3<Triangulation>;
  namespace P = CGAL::parameters;

  const SurfaceMesh surface = to_surface_mesh(closed_surface);
  // CGAL seeds its own generator, which the refinement may draw from, by the time of day.
  CGAL::get_default_random() = CGAL::Random(0);
  CGAL::Random random(0);
  const Domain domain(surface, &random);
  const Criteria criteria(P::facet_angle = 25, P::facet_size = size, P::facet_distance = size / 8,
                          P::cell_radius_edge_ratio = 2, P::cell_size = 1.2 * size);
  const Complex complex = CGAL::make_mesh_3<Complex>(
      domain, criteria, P::manifold(), P::perturb(P::sliver_bound = 12), P::exude(P::sliver_bound = 12));
  TetMesh mesh;
  std::map<Triangulation::Vertex_handle, int> index;
  std::vector<Eigen::Vector3d> points;
  mesh.T.resize(static_cast<Eigen::Index>(complex.number_of_cells_in_complex()), 4);
  Eigen::Index row = 0;
  for (auto cell = complex.cells_in_complex_begin(); cell != complex.cells_in_complex_end(); ++cell, ++row) {
    for (int k = 0; k < 4; ++k) {
      const auto [it, is_new] = index.try_emplace(cell->vertex(k), static_cast<int>(points.size()));
      const auto& p = cell->vertex(k)->point();
      if (is_new) points.emplace_back(p.x(), p.y(), p.z());
      mesh.T(row, k) = it->second;
    }
  }
  mesh.V.resize(static_cast<Eigen::Index>(points.size()), 3);
  for (std::size_t v = 0; v < points.size(); ++v) mesh.V.row(static_cast<Eigen::Index>(v)) = points[v];
  return mesh;
}

}  // namespace vivify::meshing
