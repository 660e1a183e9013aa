#include "common/mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>

#include "common/error.h"

namespace vivify {

double signed_volume(const TriangleMesh& mesh) {
  if (mesh.F.rows() == 0) return 0;
  const Eigen::Vector3d o =
      mesh.V.row(mesh.F(0, 0));  // near the surface: far from the origin the sum would cancel
  double six_volumes = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Eigen::Vector3d a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)),
                          c = mesh.V.row(mesh.F(f, 2));
    six_volumes += (a - o).dot((b - o).cross(c - o));
  }
  return six_volumes / 6;
}

Eigen::VectorXd tet_volumes(const TetMesh& mesh) { return element_sizes(sim_mesh(mesh)); }

SimMesh sim_mesh(const TetMesh& mesh) { return {mesh.V, mesh.T}; }

Eigen::VectorXd element_sizes(const SimMesh& mesh) {
  Eigen::VectorXd sizes(mesh.E.rows());
  for (Eigen::Index e = 0; e < mesh.E.rows(); ++e) {
    const auto edge = [&](int k) -> Eigen::Vector3d {
      Eigen::Vector3d d = Eigen::Vector3d::Zero();
      d.head(mesh.V.cols()) = (mesh.V.row(mesh.E(e, k)) - mesh.V.row(mesh.E(e, 0))).transpose();
      return d;
    };
    switch (mesh.element_points()) {
      case 2:
        sizes[e] = edge(1).norm();
        break;
      case 3: {
        const Eigen::Vector3d doubled = edge(1).cross(edge(2));
        sizes[e] = (mesh.dimension() == 2 ? doubled.z() : doubled.norm()) / 2;
        break;
      }
      default:
        sizes[e] = edge(1).dot(edge(2).cross(edge(3))) / 6;
    }
  }
  return sizes;
}

Eigen::VectorXd lumped_mass(const SimMesh& mesh, const Eigen::VectorXd& element_mass) {
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(mesh.V.rows());
  for (Eigen::Index e = 0; e < mesh.E.rows(); ++e) {
    for (int k = 0; k < mesh.element_points(); ++k) {
      mass[mesh.E(e, k)] += element_mass[e] / mesh.element_points();
    }
  }
  return mass;
}

Triangles boundary_faces(const TetMesh& mesh) {
  static constexpr int kFaces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  std::map<std::array<int, 3>, std::array<int, 3>> open;  // sorted face -> oriented face
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t) {
    for (const auto& corner : kFaces) {
      const std::array<int, 3> face = {mesh.T(t, corner[0]), mesh.T(t, corner[1]), mesh.T(t, corner[2])};
      std::array<int, 3> key = face;
      std::sort(key.begin(), key.end());
      if (const auto [it, inserted] = open.emplace(key, face); !inserted) open.erase(it);
    }
  }
  Triangles F(static_cast<Eigen::Index>(open.size()), 3);
  Eigen::Index row = 0;
  for (const auto& [key, face] : open) F.row(row++) << face[0], face[1], face[2];
  return F;
}

Points vertex_normals(const Points& V, const Triangles& F) {
  Points N = Points::Zero(V.rows(), 3);
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    const Eigen::RowVector3d a = V.row(F(f, 0));
    const Eigen::RowVector3d n = (V.row(F(f, 1)) - a).cross(V.row(F(f, 2)) - a);
    for (int k = 0; k < 3; ++k) N.row(F(f, k)) += n;
  }
  for (Eigen::Index v = 0; v < N.rows(); ++v) {
    const double length = N.row(v).norm();
    if (length > 0) N.row(v) /= length;
  }
  return N;
}

Box bounding_box(const Points& V) {
  if (V.rows() == 0) throw Error(ErrorKind::geometry, "the mesh has no vertices");
  return {V.colwise().minCoeff().transpose(), V.colwise().maxCoeff().transpose()};
}

}  // namespace vivify
