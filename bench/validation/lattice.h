// Structured meshes for the validation problems.
#pragma once

#include "common/mesh.h"

namespace vivify::validation {

// A straight chain of edges along x with its first vertex at x = from and its last at x = to.
SimMesh chain(int edges, double from, double to);

// A rectangle [0, length] by [−height/2, height/2] of nx by ny cells, each cut into two triangles by
// diagonals that alternate; point symmetric about every inner vertex.
SimMesh rectangle(int nx, int ny, double length, double height);

// A box [0, length] by [−height/2, height/2] by [−width/2, width/2] of cells of five tetrahedra in
// alternating orientation; point symmetric about every inner vertex.
SimMesh box(int nx, int ny, int nz, double length, double height, double width);

// A flat strip in the plane y = 0 of equilateral triangles: `rows` rows across `width` (along z), and along x
// as many as reach from about `from` to about `to`. Rows of vertices run along x; every second one is shifted
// by half an edge. Faces up.
SimMesh equilateral_strip(int rows, double width, double from, double to);

// The mesh with its vertices moved at random by up to `share` of the shortest edge, in the plane y = 0 for
// triangles in space.
SimMesh roughened(SimMesh mesh, double share, std::uint64_t seed);

double shortest_edge(const SimMesh& mesh);

// Flat vector (d #V) of the vertices.
Eigen::VectorXd flat(const RowMatrixXd& V);

// Vertices of elements' faces that belong to one element only (#V).
std::vector<bool> boundary_vertices(const SimMesh& mesh);

}  // namespace vivify::validation
