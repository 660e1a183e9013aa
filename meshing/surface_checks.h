// Whether triangles make a closed surface without self-intersections.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/mesh.h"

namespace vivify::meshing {

// What keeps the triangles from being a closed, manifold, consistently oriented surface, in words with an
// example; empty when nothing does.
std::string topology_problem(const TriangleMesh& mesh);

// Number of connected components.
int component_count(const TriangleMesh& mesh);

// Pairs of faces that intersect although they share no edge or corner there, in order. `mesh` must be
// manifold.
std::vector<std::pair<int, int>> self_intersections(const TriangleMesh& mesh);

// The mesh (V and F) with vertices at the very same place joined, which files split at texture seams; the
// order is kept.
TriangleMesh without_duplicates(const TriangleMesh& mesh);

}  // namespace vivify::meshing
