// Drawn points carried by a simulation mesh: every drawn point is a fixed affine combination of the corners
// of one element.
#pragma once

#include "common/matrix.h"
#include "common/mesh.h"

namespace vivify::meshing {

struct Embedding {
  Eigen::VectorXi element;  // #P, triangle or tetrahedron of each point
  RowMatrixXd weights;      // #P by 3 (triangles) or 4 (tetrahedra), barycentric, rows sum to 1

  // Largest |weight|. Above 2 a point lies far outside its element and exaggerates its motion: worth a
  // warning.
  double largest_weight() const { return weights.size() == 0 ? 0 : weights.cwiseAbs().maxCoeff(); }
};

// Places every point (#P by 3) in the tetrahedron that contains it; outside the mesh in the closest
// tetrahedron, with barycentric coordinates that are not clamped, so that the rest shape is reproduced and
// affine maps are exact. Among equally close tetrahedra (they share an edge or a corner) the one with the
// smallest weights is taken. Throws Error(geometry) when the mesh has no tetrahedron of positive volume or a
// point is not finite.
Embedding embed(const TetMesh& mesh, const Points& points);

// The same in the plane, for triangles F (counter-clockwise) of the vertices V.
Embedding embed(const Points2& V, const Triangles& F, const Points2& points);

// Positions of the embedded points (#P by d) for vertex positions x (#V by d) of the elements E.
RowMatrixXd interpolate(const Embedding& embedding, const Eigen::Ref<const RowMatrixXi>& E,
                        const Eigen::Ref<const RowMatrixXd>& x);

}  // namespace vivify::meshing
