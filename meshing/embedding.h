// Drawn surfaces carried by a simulation mesh: every drawn vertex is a fixed affine combination of the
// corners of one tetrahedron.
#pragma once

#include "common/mesh.h"

namespace vivify::meshing {

struct Embedding {
  Eigen::VectorXi tet;                                                // #P, tetrahedron of each point
  Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor> weights;  // #P by 4, barycentric, rows sum to 1

  // Largest |weight|. Above 2 a point lies far outside its tetrahedron and exaggerates its motion: worth a
  // warning.
  double largest_weight() const { return weights.size() == 0 ? 0 : weights.cwiseAbs().maxCoeff(); }
};

// Places every point (#P by 3) in the tetrahedron that contains it; outside the mesh in the closest
// tetrahedron, with barycentric coordinates that are not clamped, so that the rest shape is reproduced and
// affine maps are exact. Among equally close tetrahedra (they share an edge or a corner) the one with the
// smallest weights is taken. Throws Error(geometry) when the mesh has no tetrahedron of positive volume or a
// point is not finite.
Embedding embed(const TetMesh& mesh, const Points& points);

// Positions of the embedded points (#P by 3) for vertex positions x (#V by 3).
Points interpolate(const Embedding& embedding, const Tetrahedra& T, const Points& x);

}  // namespace vivify::meshing
