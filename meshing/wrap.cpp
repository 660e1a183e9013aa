#include "meshing/wrap.h"

#include <CGAL/alpha_wrap_3.h>

#include "meshing/cgal_convert.h"

namespace vivify::meshing {

TriangleMesh wrap_surface(const TriangleMesh& soup, double alpha, double offset) {
  SurfaceMesh wrap;
  CGAL::alpha_wrap_3(to_cgal_points(soup.V), to_cgal_triangles(soup.F), alpha, offset, wrap);
  return from_surface_mesh(wrap);
}

}  // namespace vivify::meshing
