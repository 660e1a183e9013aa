#include <CGAL/Polygon_mesh_processing/self_intersections.h>

#include <algorithm>
#include <iterator>

#include "meshing/cgal_convert.h"
#include "meshing/surface_checks.h"

namespace vivify::meshing {

std::vector<std::pair<int, int>> self_intersections(const TriangleMesh& mesh) {
  const SurfaceMesh surface = to_surface_mesh(mesh);
  std::vector<std::pair<SurfaceMesh::Face_index, SurfaceMesh::Face_index>> found;
  CGAL::Polygon_mesh_processing::self_intersections(surface, std::back_inserter(found));
  std::vector<std::pair<int, int>> pairs;
  for (const auto& [a, b] : found) {
    pairs.push_back(std::minmax(static_cast<int>(a.idx()), static_cast<int>(b.idx())));
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace vivify::meshing
