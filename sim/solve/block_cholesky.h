// Sparse LDLᵀ factorisation of symmetric matrices of small vertex blocks whose pattern never changes.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

namespace vivify::sim {

// Right-looking supernodal LDLᵀ without pivoting, for hundreds to thousands of degrees of freedom. Ordering
// and elimination tree are those of the graph of vertices; columns with (almost) the same rows are kept as
// one dense panel and handled by AVX2 kernels. One thread, no BLAS, every sum in a fixed order: always the
// same bits.
class BlockCholesky {
 public:
  // `lower` is the lower triangle, columns sorted, of the matrices to come; rows dim·v … dim·v + dim − 1
  // belong to vertex v.
  BlockCholesky(const Eigen::SparseMatrix<double>& lower, int dim);

  // Takes the values of a matrix in the order of the pattern. Returns false at the first pivot that is not
  // positive: the matrix is not positive definite, and solve() must not be called.
  bool factorize(const double* values);
  // Replaces the columns of x, #size by any number, by the solutions.
  void solve_in_place(Eigen::Ref<Eigen::MatrixXd> x) const;

  // Signs of all pivots, which are those of the eigenvalues (Sylvester). Ends the validity of solve().
  struct Inertia {
    int negative = 0, zero = 0, positive = 0;
  };
  Inertia inertia(const double* values);

  int size() const { return size_; }
  // Entries kept of L, with its diagonal and the zeros that the panels hold.
  long nonzeros() const { return nonzeros_; }
  // Multiplications and additions of one factorisation.
  double flops() const { return flops_; }
  int panel_count() const { return static_cast<int>(panels_.size()); }

 private:
  // Columns first … first + width − 1 of L with the same rows: a dense array of `stride` (a multiple of 4) by
  // width, whose rows are the columns themselves and then rows_[row_begin …].
  struct Panel {
    int first, width, height, stride;
    int row_begin;     // in rows_ and, divided by dim, in targets_
    long value_begin;  // in values_
  };
  // Rows begin … end − 1 below the columns of a panel, which are rows begin + shift … of a target.
  struct Run {
    int begin, end, shift;
  };
  // Where the update of the columns of one vertex among the rows of a panel goes.
  struct Target {
    long column;  // first of the columns, in values_
    int stride;
    int first_run, last_run;  // in runs_
  };

  void make_panels(const Eigen::SparseMatrix<double>& lower);
  void make_targets();
  template <bool kToTheEnd>
  bool factorize(const double* values);
  template <bool kToTheEnd>
  bool factorize_panel(const Panel& panel);
  void update_targets(const Panel& panel);
  void solve_one(double* x) const;
  void solve_many(double* x, int count) const;

  int dim_, size_;
  std::vector<int> position_;  // of each vertex in the order of elimination
  std::vector<Panel> panels_;
  std::vector<int> rows_;        // of all panels, below their columns
  std::vector<Target> targets_;  // of each vertex in rows_
  std::vector<Run> runs_;
  std::vector<long> slots_;  // place in values_ of every value of the matrix
  long nonzeros_ = 0;
  double flops_ = 0;

  std::vector<double> values_, pivots_, inverse_pivots_;
  std::vector<double> packed_, product_;  // scratch of the factorisation
};

}  // namespace vivify::sim
