#include "meshing/wrap.h"

#include <CGAL/alpha_wrap_3.h>

#include "meshing/cgal_convert.h"

namespace vivify::meshing {

TriangleMesh wrap_surface(const TriangleMesh& soup, double alpha, double offset) {
  const Box box = bounding_box(soup.V);  // at size 1 round the origin: far away, coordinates are too coarse
  const Eigen::RowVector3d centre = (0.5 * (box.min + box.max)).transpose();
  const double size = box.diagonal();
  const Points scaled = (soup.V.rowwise() - centre) / size;
  SurfaceMesh wrap;
  CGAL::alpha_wrap_3(to_cgal_points(scaled), to_cgal_triangles(soup.F), alpha / size, offset / size, wrap);
  TriangleMesh mesh = from_surface_mesh(wrap);
  mesh.V = ((mesh.V * size).rowwise() + centre).eval();
  return mesh;
}

}  // namespace vivify::meshing
