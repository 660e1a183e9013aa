// Measures of surfaces and tetrahedral meshes.
#pragma once

#include <Eigen/Core>
#include <array>

#include "common/mesh.h"

namespace vivify::meshing {

// The six dihedral angles of a tetrahedron (degrees), at the edges 01, 02, 03, 12, 13, 23.
std::array<double, 6> dihedral_angles(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                      const Eigen::Vector3d& c, const Eigen::Vector3d& d);

// Smallest and largest dihedral angle of a mesh (degrees).
struct AngleRange {
  double min = 180;
  double max = 0;
};
AngleRange dihedral_range(const TetMesh& mesh);

// Number of parts that are connected through shared vertices; vertices of no element do not count.
int component_count(const Triangles& F);
int component_count(const Tetrahedra& T);

// Every edge belongs to two triangles, which run through it in opposite directions.
bool is_closed_oriented(const Triangles& F);
// Every edge belongs to at most two triangles and the triangles round every vertex form one fan.
bool is_manifold(const Triangles& F);

// Vertices − edges + triangles of those vertices that are used; 2 for each sphere, 0 for each torus.
int euler_characteristic(const Triangles& F);

// Removes the vertices that no element uses; keeps the order of the others.
void drop_unused_vertices(TriangleMesh& mesh);
void drop_unused_vertices(TetMesh& mesh);

}  // namespace vivify::meshing
