// How the drawn surface of a body follows its simulation mesh.
#pragma once

#include "common/matrix.h"
#include "common/mesh.h"
#include "meshing/embedding.h"

namespace vivify::meshing {

// Each drawn vertex is a fixed affine combination of the corners of one element, moved along the normal of
// the rod or shell there, and for bodies of the plane put at a fixed depth.
struct Skin {
  Embedding embedding;     // #P
  Eigen::VectorXd offset;  // #P, metres along the normal of a rod or shell; empty: none
  Eigen::VectorXd depth;   // #P, z of bodies of the plane, m; empty for bodies of space
};

// Positions (#P by 3) of the drawn vertices for vertex positions x (#V by d) of the elements E.
Points draw(const Skin& skin, const Eigen::Ref<const RowMatrixXi>& E, const Eigen::Ref<const RowMatrixXd>& x);

// A surface with the skin that moves it.
struct SkinnedSurface {
  TriangleMesh surface;  // at rest
  Skin skin;
};

// Each given vertex of the elements E, embedded in an element that has it.
Embedding embed_vertices(const Eigen::Ref<const RowMatrixXi>& E, const Eigen::VectorXi& vertices);
// All vertices of the edges or triangles E, then the middles of the edges, each once.
Embedding embed_edges(const Eigen::Ref<const RowMatrixXi>& E);

// A rod of the plane as a band: its section is a rectangle of `thickness` in the plane by `depth` across it,
// about z, with edges bevelled by `bevel` (metres). Open rods have flat ends. The edges E follow one another.
SkinnedSurface rod_band(const Points2& V, const Edges& E, double thickness, double depth, double bevel,
                        double z);

// A shell as a plate of the given thickness: both sides of `surface` (which may be split at texture seams and
// finer than the simulation), and a rim along its borders. It follows the triangles F (facing alike) of the
// points V: each drawn vertex the nearest point of them, at the distance that it has at rest. Parts and
// texture coordinates are those of `surface`.
SkinnedSurface thick_shell(const TriangleMesh& surface, const Points& V, const Triangles& F,
                           double thickness);

}  // namespace vivify::meshing
