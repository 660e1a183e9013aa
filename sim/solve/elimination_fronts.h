// Order of elimination of a sparse symmetric matrix, and the columns of its factor that share their rows.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

namespace vivify::sim {

// Vertices whose columns of L are eliminated together. `rows` are the later vertices in those columns,
// ascending.
struct Front {
  std::vector<int> columns, rows;
};

struct Elimination {
  std::vector<int> position;  // of every vertex in the order of elimination
  // In the order of elimination; columns and rows are positions, columns are consecutive over all fronts.
  std::vector<Front> fronts;
  // Ends, in this list, of subtrees that come first: whole ones of the tree of elimination, the root last, so
  // that no column of one has rows in another. Small matrices have none.
  std::vector<int> subtree_ends;
};

// Chooses the order on the graph of vertices (rows dim·v … dim·v + dim − 1 of the matrix belong to vertex v)
// so that a factorisation over dense fronts is estimated to be quick. Always the same for the same pattern.
Elimination order_elimination(const Eigen::SparseMatrix<double>& lower, int dim);

// Multiplications and additions that eliminate `width` columns with `below` rows under them and update the
// triangle of those rows.
double elimination_flops(double width, double below);

}  // namespace vivify::sim
