// Sparse LDLᵀ factorisation of symmetric matrices of small vertex blocks whose pattern never changes.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "sim/solve/elimination_fronts.h"

namespace vivify::sim {

// Supernodal and right-looking, without pivoting, for tens to thousands of degrees of freedom: each front of
// the elimination is a dense panel, handled by AVX2 kernels. Subtrees of a large elimination are shared out
// between threads: each has copies of the unknowns outside it that it bears on, which are added up
// afterwards. No BLAS, every sum in a fixed order: always the same bits (docs/decisions/0002-determinism.md).
class BlockCholesky {
 public:
  // `lower` is the lower triangle of the matrices to come, columns sorted; rows dim·v … dim·v + dim − 1
  // (dim <= 3) belong to vertex v.
  BlockCholesky(const Eigen::SparseMatrix<double>& lower, int dim);

  // Takes the values of a matrix in the order of the pattern. False at the first pivot that is not positive:
  // the matrix is not positive definite, and solve_in_place() must not be called.
  bool factorize(const double* values);
  // Replaces the columns of x, #size by any number, by the solutions.
  void solve_in_place(Eigen::Ref<Eigen::MatrixXd> x) const;

  // Signs of all pivots, which are those of the eigenvalues (Sylvester). Replaces the factorisation.
  struct Inertia {
    int negative = 0, zero = 0, positive = 0;
  };
  Inertia inertia(const double* values);

  int size() const { return size_; }
  int panel_count() const { return static_cast<int>(panels_.size()); }
  // Entries kept of L, with its diagonal and the zeros inside the panels.
  long nonzeros() const;
  // Multiplications and additions of one factorisation.
  double flops() const;

 private:
  // Columns first … first + width − 1 of L: a dense array of `stride` (a multiple of 4) by width, whose rows
  // are the columns themselves and then rows_[row_begin …]. On and above the diagonal it holds no meaning.
  struct Panel {
    int first, width, height, stride;
    int row_begin;     // in rows_ and, divided by dim, in targets_
    long value_begin;  // in values_

    int below() const { return height - width; }
  };
  // Up to four rows from `row` below the columns of a panel on, which are rows from `place` on of another.
  struct Chunk {
    int row, place, count;
  };
  // Where the update of the columns of one vertex among the rows of a panel goes.
  struct Target {
    long column;  // the first of the columns, in values_
    int stride;
    // Of the rows from the vertex on, in chunks_; the first chunk may hold rows above the diagonal too.
    int first_chunk, last_chunk;
  };

  // Panels first_panel … end_panel − 1, the last of them the root, and one of its own for the unknowns
  // outside that it bears on: column i of `border` is that of row i of the root below its columns, and is
  // called border.first + i, which is size_ or more. rows_ of the border are those unknowns.
  struct Subtree {
    int first_panel, end_panel;
    Panel border;
    long value_begin, value_end;  // of all these panels
  };
  // Of one thread at a time.
  struct Scratch {
    std::vector<double> packed, product;
  };

  void make_panels(const Elimination& elimination);
  void make_slots(const Eigen::SparseMatrix<double>& lower, const std::vector<int>& panel_of);
  void call_by_border();
  void make_targets(std::vector<int> panel_of);
  int first_outside() const { return subtrees_.empty() ? 0 : subtrees_.back().end_panel; }
  template <bool kToTheEnd>
  bool factorize(const double* values);
  template <bool kToTheEnd>
  bool eliminate(int first_panel, int end_panel, Scratch& scratch);
  void update_targets(const Panel& panel, Scratch& scratch);
  void add_to_targets(int row_begin, int columns, const double* product, long product_stride);
  void forward(double* x, int count, int first_panel, int end_panel) const;
  void backward(double* x, int count, int first_panel, int end_panel) const;
  void forward_one(double* x, int first_panel, int end_panel) const;
  void backward_one(double* x, int first_panel, int end_panel) const;
  template <int kVectors>
  void forward_columns(double* x, long count, int first_panel, int end_panel) const;
  template <int kVectors>
  void backward_columns(double* x, long count, int first_panel, int end_panel) const;

  int dim_, size_;
  std::vector<int> position_;  // of each vertex in the order of elimination
  std::vector<Panel> panels_;  // of the subtrees, then those outside
  std::vector<Subtree> subtrees_;
  int border_columns_ = 0;       // of all subtrees
  std::vector<int> rows_;        // of all panels, below their columns
  std::vector<Target> targets_;  // of each vertex in rows_
  std::vector<Chunk> chunks_;
  std::vector<long> slots_;  // place in values_ of every value of the matrix
  int most_rows_ = 0;        // of a panel

  std::vector<double> values_, pivots_, inverse_pivots_;
  std::vector<Scratch> scratch_;  // of each subtree, and of what is outside
};

}  // namespace vivify::sim
