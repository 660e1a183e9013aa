#include "sim/solve/sparse_matrix.h"

#include <algorithm>

namespace vivify::sim {

void SymmetricPattern::couple(const int* vertices, int count, int first) {
  for (int a = 0; a < count; ++a) {
    for (int b = 0; b < count; ++b) {
      if (vertices[a] >= vertices[b]) blocks_.emplace(first + vertices[b], first + vertices[a]);
    }
  }
}

void SymmetricPattern::finish() {
  std::vector<Eigen::Triplet<double>> entries;
  const int d = dimension_;
  entries.reserve(static_cast<std::size_t>(d * d) * blocks_.size());
  for (const auto& [column, row] : blocks_) {
    for (int i = 0; i < d; ++i) {
      for (int j = 0; j < d; ++j) {
        if (d * row + i >= d * column + j) entries.emplace_back(d * row + i, d * column + j, 0.0);
      }
    }
  }
  zeros_.resize(size(), size());
  zeros_.setFromTriplets(entries.begin(), entries.end());
  zeros_.makeCompressed();
}

int SymmetricPattern::slot(int row, int column) const {
  const int* begin = zeros_.innerIndexPtr() + zeros_.outerIndexPtr()[column];
  const int* end = zeros_.innerIndexPtr() + zeros_.outerIndexPtr()[column + 1];
  const int* found = std::lower_bound(begin, end, row);
  return found != end && *found == row ? static_cast<int>(found - zeros_.innerIndexPtr()) : -1;
}

void SymmetricPattern::append_slots(const int* vertices, int count, std::vector<int>& slots,
                                    int first) const {
  const int d = dimension_;
  for (int column = 0; column < d * count; ++column) {
    for (int row = column; row < d * count; ++row) {
      const int global_row = d * (first + vertices[row / d]) + row % d,
                global_column = d * (first + vertices[column / d]) + column % d;
      slots.push_back(slot(std::max(global_row, global_column), std::min(global_row, global_column)));
    }
  }
}

void SymmetricPattern::append_columns(const int* vertices, int count, std::vector<int>& columns,
                                      std::vector<double>& turned, int first) const {
  const int d = dimension_;
  for (int a = 0; a < count; ++a) {
    for (int b = 0; b <= a; ++b) {
      const int row = first + std::max(vertices[a], vertices[b]),
                column = first + std::min(vertices[a], vertices[b]);
      turned.push_back(vertices[a] < vertices[b] ? 1 : 0);
      for (int k = 0; k < d; ++k) columns.push_back(slot(d * row + (a == b ? k : 0), d * column + k));
    }
  }
}

}  // namespace vivify::sim
