// Plain mesh data: points are #V by 3, elements #F by 3 or #T by 4, indices count from 0, counter-clockwise is outward.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/matrix.h"

namespace vivify {

using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;     // #V by 3, metres
using Points2 = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;    // #V by 2, metres
using Edges = Eigen::Matrix<int, Eigen::Dynamic, 2, Eigen::RowMajor>;         // #E by 2
using Triangles = Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor>;     // #F by 3
using Tetrahedra = Eigen::Matrix<int, Eigen::Dynamic, 4, Eigen::RowMajor>;    // #T by 4
using TexCoords = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;  // #V by 2

// A triangle surface or soup.
struct TriangleMesh {
  Points V;
  Triangles F;
  TexCoords UV;                        // #V by 2, or empty
  Eigen::VectorXi face_part;           // #F, index into part_names; empty: all faces are part 0
  std::vector<std::string> part_names; // names of the parts (materials of the asset file); may be empty
};

struct TetMesh {
  Points V;
  Tetrahedra T;  // positive orientation: det(x1 − x0, x2 − x0, x3 − x0) > 0
};

// A mesh to simulate, in the plane or in space. The columns tell what it is: two coordinates and two, three points per
// element for rods and flat solids, three coordinates and three, four points per element for shells and solids.
struct SimMesh {
  RowMatrixXd V;  // #V by 2 or 3
  RowMatrixXi E;  // #E by 2 (edges), 3 (triangles; counter-clockwise in the plane) or 4 (tetrahedra, positive)
  int dimension() const { return static_cast<int>(V.cols()); }
  int element_points() const { return static_cast<int>(E.cols()); }
};
SimMesh sim_mesh(const TetMesh& mesh);

// Sizes of the elements (#E): lengths (m), areas (m², signed in the plane) or volumes (m³, signed).
Eigen::VectorXd element_sizes(const SimMesh& mesh);

// Volume enclosed by a closed, outward oriented surface (m³); signed.
double signed_volume(const TriangleMesh& mesh);

// Signed volumes of the tetrahedra (#T, m³).
Eigen::VectorXd tet_volumes(const TetMesh& mesh);

// Lumped mass of the vertices (#V, kg): the mass of each element (#E, kg) in equal parts to its points.
Eigen::VectorXd lumped_mass(const SimMesh& mesh, const Eigen::VectorXd& element_mass);

// Boundary triangles of a tetrahedral mesh, outward, indexing into mesh.V (#F by 3).
Triangles boundary_faces(const TetMesh& mesh);

// Area-weighted unit vertex normals (#V by 3); zero for vertices without faces.
Points vertex_normals(const Points& V, const Triangles& F);

// Bounding box corners, and the length of its diagonal. Throws Error(geometry) when there are no points.
struct Box {
  Eigen::Vector3d min;
  Eigen::Vector3d max;
  double diagonal() const { return (max - min).norm(); }
};
Box bounding_box(const Points& V);

}  // namespace vivify
