// Symmetric sparse matrices with a pattern that is fixed per character: the pattern is analysed once, and
// assembly writes straight into the array of values.
#pragma once

#include <Eigen/SparseCore>
#include <set>
#include <utility>
#include <vector>

namespace vivify::sim {

// The lower triangle of a symmetric matrix of vertex blocks, dimension by dimension.
class SymmetricPattern {
 public:
  SymmetricPattern(int vertex_count, int dimension) : vertex_count_(vertex_count), dimension_(dimension) {}

  // All pairs of the given vertices may be coupled. Here and below `first` is added to the vertices.
  void couple(const int* vertices, int count, int first = 0);
  // Ends the collection; needed before slot().
  void finish();

  int dimension() const { return dimension_; }
  int size() const { return dimension_ * vertex_count_; }
  // Place of entry (row, column) of the lower triangle (row >= column) in the array of values; -1 if not in
  // the pattern.
  int slot(int row, int column) const;
  // Places of the lower triangle of the block of `count` vertices, column by column of it.
  void append_slots(const int* vertices, int count, std::vector<int>& slots, int first = 0) const;
  // Where the columns of the vertex blocks (a, b), a >= b, of `count` vertices begin: for each pair and
  // column the place of its first entry (on the diagonal that of the diagonal itself). `turned` has a 1 for
  // pairs that are stored transposed, because vertex a comes before vertex b in the matrix.
  void append_columns(const int* vertices, int count, std::vector<int>& columns, std::vector<double>& turned,
                      int first = 0) const;

  // A matrix of zeros with this pattern.
  const Eigen::SparseMatrix<double>& zeros() const { return zeros_; }

 private:
  int vertex_count_;
  int dimension_;
  std::set<std::pair<int, int>> blocks_;  // (column vertex, row vertex), row >= column
  Eigen::SparseMatrix<double> zeros_;
};

// A matrix over a pattern; the pattern must outlive it.
class SymmetricMatrix {
 public:
  explicit SymmetricMatrix(const SymmetricPattern& pattern) : lower_(pattern.zeros()) {}

  void set_zero() { lower_.coeffs().setZero(); }
  double* values() { return lower_.valuePtr(); }
  const Eigen::SparseMatrix<double>& lower() const { return lower_; }
  Eigen::SparseMatrix<double>& lower() { return lower_; }
  // Product with a vector or with the columns of a matrix.
  Eigen::MatrixXd operator*(const Eigen::MatrixXd& rhs) const {
    return lower_.selfadjointView<Eigen::Lower>() * rhs;
  }

 private:
  Eigen::SparseMatrix<double> lower_;
};

}  // namespace vivify::sim
