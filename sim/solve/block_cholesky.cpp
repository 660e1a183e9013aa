#include "sim/solve/block_cholesky.h"

#include <algorithm>
#include <cmath>

#include "common/parallel.h"
#include "sim/solve/dense_tile.h"

namespace vivify::sim {
namespace {

constexpr int kSlack = 16;         // entries that a kernel may read or write behind an array
constexpr int kPanelColumns = 4;   // eliminated at once
constexpr int kUpdateColumns = 6;  // whole vertices in two and three dimensions
constexpr int kSolveRows = 4;      // with up to 12 right-hand sides at once

int round_up(int count, int multiple) { return (count + multiple - 1) / multiple * multiple; }

// The factor B of a product: kColumns rows of `depth` columns of a panel, each column times its pivot.
template <int kColumns>
void pack(const double* rows, long stride, const double* pivots, int depth, double* packed) {
  for (int k = 0; k < depth; ++k, rows += stride, packed += kColumns) {
    const Vector4 pivot = _mm256_broadcast_sd(pivots + k);
    for (int j = 0; j < kColumns; j += kLanes) {
      _mm256_storeu_pd(packed + j, _mm256_mul_pd(_mm256_loadu_pd(rows + j), pivot));
    }
  }
}

// Columns begin … begin + kColumns − 1 of a panel whose earlier columns are done.
template <int kColumns, bool kToTheEnd>
bool eliminate_columns(double* panel, long stride, int begin, double* packed, double* pivots,
                       double* inverse_pivots) {
  pack<kColumns>(panel + begin, stride, pivots, begin, packed);
  double* columns = panel + begin * stride;
  Tile<1, kColumns> top;
  top.load([&](int j) { return columns + begin + j * stride; });
  top.subtract_product(panel + begin, stride, packed, kColumns, 1, begin);
  double product[kColumns][kPanelColumns], factor[kColumns][kPanelColumns];  // columns of L D and L
  top.store([&](int j) { return product[j]; });
  for (int i = 0; i < kColumns; ++i) {
    const double pivot = product[i][i];
    if (!kToTheEnd && !(pivot > 0 && std::isfinite(pivot))) return false;
    const double inverse = pivot != 0 ? 1 / pivot : 0;
    pivots[begin + i] = pivot;
    inverse_pivots[begin + i] = inverse;
    for (int row = i + 1; row < kPanelColumns; ++row) {
      factor[i][row] = product[i][row] * inverse;
      columns[begin + row + i * stride] = factor[i][row];
    }
    for (int j = i + 1; j < kColumns; ++j) {
      for (int row = j; row < kPanelColumns; ++row) product[j][row] -= product[i][row] * factor[i][j];
    }
  }
  const auto eliminate_rows = [&](auto vectors, int row) {
    Tile<vectors(), kColumns> tile;
    tile.load([&](int j) { return columns + row + j * stride; });
    tile.subtract_product(panel + row, stride, packed, kColumns, 1, begin);
#pragma GCC unroll 16
    for (int i = 0; i < kColumns; ++i) {
#pragma GCC unroll 16
      for (int j = i + 1; j < kColumns; ++j) tile.eliminate(j, i, factor[i][j]);
    }
#pragma GCC unroll 16
    for (int i = 0; i < kColumns; ++i) tile.scale(i, inverse_pivots[begin + i]);
    tile.store([&](int j) { return columns + row + j * stride; });
  };
  for (int row = begin + kPanelColumns; row < stride; row += 3 * kLanes) {
    with_constant<3>(std::min(3, static_cast<int>(stride - row) / kLanes),
                     [&](auto vectors) { eliminate_rows(vectors, row); });
  }
  return true;
}

// Calls function(part) for all, on several threads.
template <typename Part, typename Function>
void each(const std::vector<Part>& parts, const Function& function) {
  if (!parts.empty()) parallel_for(parts.size(), [&](std::size_t i) { function(parts[i]); });
}

}  // namespace

// ---- Analysis ----

BlockCholesky::BlockCholesky(const Eigen::SparseMatrix<double>& lower, int dim)
    : dim_(dim), size_(static_cast<int>(lower.cols())) {
  Elimination elimination = order_elimination(lower, dim);
  make_panels(elimination);
  std::vector<int> panel_of;  // of every position
  for (const Panel& panel : panels_) {
    panel_of.insert(panel_of.end(), static_cast<std::size_t>(panel.width / dim),
                    static_cast<int>(&panel - panels_.data()));
  }
  position_ = std::move(elimination.position);
  make_slots(lower, panel_of);
  call_by_border();
  make_targets(std::move(panel_of));
}

void BlockCholesky::make_panels(const Elimination& elimination) {
  long values = 0;
  int first = 0, most_width = 0;
  for (const Front& front : elimination.fronts) {
    const int width = dim_ * static_cast<int>(front.columns.size());
    const int height = width + dim_ * static_cast<int>(front.rows.size());
    const int stride = round_up(height, kLanes);
    panels_.push_back({first, width, height, stride, static_cast<int>(rows_.size()), values});
    for (const int vertex : front.rows) {
      for (int i = 0; i < dim_; ++i) rows_.push_back(dim_ * vertex + i);
    }
    first += width;
    values += long(stride) * width;
    most_rows_ = std::max(most_rows_, stride);
    most_width = std::max(most_width, width);
    const std::vector<int>& ends = elimination.subtree_ends;
    if (subtrees_.size() == ends.size() || panel_count() != ends[subtrees_.size()]) continue;
    const int below = height - width, border_stride = round_up(below, kLanes);
    const int first_panel = first_outside();
    const Panel border = {size_ + border_columns_,        below, below, border_stride,
                          static_cast<int>(rows_.size()), values};
    for (int row = 0; row < below; ++row) rows_.push_back(rows_[panels_.back().row_begin + row]);
    border_columns_ += below;
    values += long(border_stride) * below + kSlack;
    subtrees_.push_back({first_panel, panel_count(), border, panels_[first_panel].value_begin, values});
  }
  values_.resize(static_cast<std::size_t>(values + kSlack));
  pivots_.resize(static_cast<std::size_t>(size_));
  inverse_pivots_.resize(static_cast<std::size_t>(size_));
  scratch_.resize(subtrees_.size() + 1);
  for (Scratch& scratch : scratch_) {
    scratch.packed.resize(static_cast<std::size_t>(kUpdateColumns * most_width + kSlack));
    scratch.product.resize(static_cast<std::size_t>(kUpdateColumns * (most_rows_ + kSlack)));
  }
}

void BlockCholesky::make_slots(const Eigen::SparseMatrix<double>& lower, const std::vector<int>& panel_of) {
  const auto place = [&](int index) { return dim_ * position_[index / dim_] + index % dim_; };
  slots_.reserve(static_cast<std::size_t>(lower.nonZeros()));
  for (int j = 0; j < size_; ++j) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(lower, j); it; ++it) {
      const auto [column, row] = std::minmax({place(j), place(static_cast<int>(it.row()))});
      const Panel& panel = panels_[panel_of[column / dim_]];
      int panel_row = row - panel.first;
      if (panel_row >= panel.width) {
        const auto begin = rows_.begin() + panel.row_begin;
        panel_row =
            panel.width + static_cast<int>(std::lower_bound(begin, begin + panel.below(), row) - begin);
      }
      slots_.push_back(panel.value_begin + long(column - panel.first) * panel.stride + panel_row);
    }
  }
}

// Calls the rows of subtrees that lie outside them by the columns of the border.
void BlockCholesky::call_by_border() {
  for (const Subtree& subtree : subtrees_) {
    const Panel& root = panels_[subtree.end_panel - 1];
    const auto border = rows_.begin() + subtree.border.row_begin;
    for (int p = subtree.first_panel; p < subtree.end_panel; ++p) {
      auto found = border;
      for (int i = 0; i < panels_[p].below(); ++i) {
        int& row = rows_[panels_[p].row_begin + i];
        if (row < root.first + root.width) continue;
        found = std::lower_bound(found, border + subtree.border.width, row);
        row = subtree.border.first + static_cast<int>(found - border);
      }
    }
  }
}

void BlockCholesky::make_targets(std::vector<int> panel_of) {
  std::vector<const Panel*> panels;
  for (const Panel& panel : panels_) panels.push_back(&panel);
  for (const Subtree& subtree : subtrees_) {
    panel_of.insert(panel_of.end(), static_cast<std::size_t>(subtree.border.width / dim_),
                    static_cast<int>(panels.size()));
    panels.push_back(&subtree.border);
  }
  const auto add_targets = [&](const int* rows, int count) {
    for (int i = 0; i < count;) {
      const Panel& target = *panels[panel_of[rows[i] / dim_]];
      const int* target_rows = rows_.data() + target.row_begin;
      const int* found = target_rows;
      int chunk = static_cast<int>(chunks_.size());
      for (int j = i; j < count; j += dim_) {
        int place = rows[j] - target.first;
        if (place >= target.width) {
          found = std::lower_bound(found, target_rows + target.below(), rows[j]);
          place = target.width + static_cast<int>(found - target_rows);
        }
        for (int k = 0; k < dim_; ++k) {
          const bool joined = j + k > i && chunks_.back().count < kLanes &&
                              place + k == chunks_.back().place + chunks_.back().count;
          if (joined) {
            ++chunks_.back().count;
          } else {
            chunks_.push_back({j + k, place + k, 1});
          }
        }
      }
      for (; i < count && rows[i] < target.first + target.width; i += dim_) {
        while (chunks_[chunk].row + chunks_[chunk].count <= i) ++chunk;
        targets_.push_back({target.value_begin + long(rows[i] - target.first) * target.stride, target.stride,
                            chunk, static_cast<int>(chunks_.size())});
      }
    }
  };
  auto subtree = subtrees_.begin();
  for (const Panel& panel : panels_) {  // in the order of rows_
    add_targets(rows_.data() + panel.row_begin, panel.below());
    if (subtree == subtrees_.end() || &panel != &panels_[subtree->end_panel - 1]) continue;
    add_targets(rows_.data() + subtree->border.row_begin, subtree->border.width);
    ++subtree;
  }
}

long BlockCholesky::nonzeros() const {
  long count = 0;
  for (const Panel& panel : panels_)
    count += long(panel.width) * (panel.width + 1) / 2 + long(panel.width) * panel.below();
  return count;
}

double BlockCholesky::flops() const {
  double count = 0;
  for (const Panel& panel : panels_) count += elimination_flops(panel.width, panel.below());
  return count;
}

// ---- Factorisation ----

template <bool kToTheEnd>
bool BlockCholesky::factorize(const double* values) {
  const long outside = subtrees_.empty() ? 0 : subtrees_.back().value_end;
  each(subtrees_, [&](const Subtree& subtree) {
    std::fill(values_.begin() + subtree.value_begin, values_.begin() + subtree.value_end, 0);
  });
  std::fill(values_.begin() + outside, values_.end(), 0);
  for (const long slot : slots_) values_[slot] = *values++;
  std::vector<char> done(subtrees_.size());
  each(subtrees_, [&](const Subtree& subtree) {
    const std::size_t i = static_cast<std::size_t>(&subtree - subtrees_.data());
    done[i] = eliminate<kToTheEnd>(subtree.first_panel, subtree.end_panel, scratch_[i]);
  });
  if (std::find(done.begin(), done.end(), false) != done.end()) return false;
  for (const auto& [first_panel, end_panel, border, value_begin, value_end] : subtrees_)
    add_to_targets(border.row_begin, border.width, values_.data() + border.value_begin, border.stride);
  return eliminate<kToTheEnd>(first_outside(), panel_count(), scratch_.back());
}

template <bool kToTheEnd>
bool BlockCholesky::eliminate(int first_panel, int end_panel, Scratch& scratch) {
  for (int p = first_panel; p < end_panel; ++p) {
    const Panel& panel = panels_[p];
    for (int begin = 0; begin < panel.width; begin += kPanelColumns) {
      const bool done =
          with_constant<kPanelColumns>(std::min(kPanelColumns, panel.width - begin), [&](auto columns) {
            return eliminate_columns<columns(), kToTheEnd>(
                values_.data() + panel.value_begin, panel.stride, begin, scratch.packed.data(),
                pivots_.data() + panel.first, inverse_pivots_.data() + panel.first);
          });
      if (!done) return false;
    }
    update_targets(panel, scratch);
  }
  return true;
}

bool BlockCholesky::factorize(const double* values) { return factorize<false>(values); }

BlockCholesky::Inertia BlockCholesky::inertia(const double* values) {
  factorize<true>(values);
  Inertia result;
  for (const double pivot : pivots_) {
    ++(pivot < 0 ? result.negative : pivot > 0 ? result.positive : result.zero);
  }
  return result;
}

// Subtracts L D Lᵀ of the rows below a panel from the panels of those rows.
void BlockCholesky::update_targets(const Panel& panel, Scratch& scratch) {
  const long stride = panel.stride;
  double *packed = scratch.packed.data(), *product = scratch.product.data() + kSlack;
  for (int begin = 0; begin < panel.below(); begin += kUpdateColumns) {
    const double* rows = values_.data() + panel.value_begin + panel.width + begin;
    const int count = panel.below() - begin, columns = std::min(kUpdateColumns, count);
    const long product_stride = round_up(count, 2 * kLanes);
    with_constant<kUpdateColumns>(columns, [&](auto constant) {
      constexpr int kColumns = constant();
      pack<kColumns>(rows, stride, pivots_.data() + panel.first, panel.width, packed);
      for (int row = 0; row < count; row += 2 * kLanes) {
        with_constant<2>(count - row > kLanes ? 2 : 1, [&](auto vectors) {
          Tile<vectors(), kColumns> tile;
          tile.set_zero();
          tile.subtract_product(rows + row, stride, packed, kColumns, 1, panel.width);
          tile.store([&](int j) { return product + row + j * product_stride; });
        });
      }
    });
    add_to_targets(panel.row_begin + begin, columns, product - begin, product_stride);
  }
}

// Adds columns of a product, which are those of the unknowns rows_[row_begin …], to the panels of these.
void BlockCholesky::add_to_targets(int row_begin, int columns, const double* product, long product_stride) {
  with_constant<3>(dim_, [&](auto constant) {
    constexpr int kDim = constant();
    for (int column = 0; column < columns; column += kDim) {
      const Target& target = targets_[(row_begin + column) / kDim];
      double* to = values_.data() + target.column;
      const double* from = product + column * product_stride;
      for (int c = target.first_chunk; c < target.last_chunk; ++c) {
        const Chunk& chunk = chunks_[c];
        const Vector4 mask = first_lanes(chunk.count);
        for (int i = 0; i < kDim; ++i) {
          double* place = to + chunk.place + i * target.stride;
          const Vector4 added = _mm256_and_pd(_mm256_loadu_pd(from + chunk.row + i * product_stride), mask);
          _mm256_storeu_pd(place, _mm256_add_pd(_mm256_loadu_pd(place), added));
        }
      }
    }
  });
}

// ---- Solution ----

void BlockCholesky::solve_in_place(Eigen::Ref<Eigen::MatrixXd> x) const {
  // The right-hand sides of one degree of freedom beside each other, in the order of elimination; then those
  // of the borders.
  const int count = static_cast<int>(x.cols()), stride = count == 1 ? 1 : round_up(count, kLanes);
  std::vector<double> ordered(static_cast<std::size_t>(stride) *
                              static_cast<std::size_t>(size_ + border_columns_));
  const auto each_value = [&](const auto& call) {
    for (int column = 0; column < count; ++column) {
      double* from = x.data() + column * x.outerStride();
      for (const int position : position_) {
        double* to = ordered.data() + long(position) * dim_ * stride + column;
        for (int i = 0; i < dim_; ++i, ++from, to += stride) call(*from, *to);
      }
    }
  };
  // Calls function(entry of a border, entry that it stands for).
  const auto each_border_value = [&](const auto& function) {
    for (const Subtree& subtree : subtrees_) {
      double* own = ordered.data() + long(subtree.border.first) * stride;
      for (int row = 0; row < subtree.border.width; ++row) {
        double* other = ordered.data() + long(rows_[subtree.border.row_begin + row]) * stride;
        for (int i = 0; i < stride; ++i) function(*own++, *other++);
      }
    }
  };
  each_value([](double given, double& place) { place = given; });
  each(subtrees_, [&](const Subtree& subtree) {
    forward(ordered.data(), stride, subtree.first_panel, subtree.end_panel);
  });
  each_border_value([](double own, double& other) { other += own; });
  forward(ordered.data(), stride, first_outside(), panel_count());
  backward(ordered.data(), stride, first_outside(), panel_count());
  each_border_value([](double& own, double other) { own = other; });
  each(subtrees_, [&](const Subtree& subtree) {
    backward(ordered.data(), stride, subtree.first_panel, subtree.end_panel);
  });
  each_value([](double& given, double solved) { given = solved; });
}

// `count` right-hand sides: by the columns of L in some panels, and back by those of D Lᵀ.
void BlockCholesky::forward(double* x, int count, int first_panel, int end_panel) const {
  if (count == 1) return forward_one(x, first_panel, end_panel);
  for (int column = 0; column < count; column += 3 * kLanes) {
    with_constant<3>(std::min(3, (count - column) / kLanes), [&](auto vectors) {
      forward_columns<vectors()>(x + column, count, first_panel, end_panel);
    });
  }
}

void BlockCholesky::backward(double* x, int count, int first_panel, int end_panel) const {
  if (count == 1) return backward_one(x, first_panel, end_panel);
  for (int column = 0; column < count; column += 3 * kLanes) {
    with_constant<3>(std::min(3, (count - column) / kLanes), [&](auto vectors) {
      backward_columns<vectors()>(x + column, count, first_panel, end_panel);
    });
  }
}

void BlockCholesky::forward_one(double* x, int first_panel, int end_panel) const {
  std::vector<double> scratch(static_cast<std::size_t>(most_rows_));
  double* y = scratch.data();  // the rows of a panel
  for (int p = first_panel; p < end_panel; ++p) {
    const Panel& panel = panels_[p];
    const int* rows = rows_.data() + panel.row_begin;
    const long stride = panel.stride;
    std::copy_n(x + panel.first, panel.width, y);
    std::fill(y + panel.width, y + stride, 0.0);
    for (int begin = 0; begin < panel.width; begin += kPanelColumns) {
      with_constant<kPanelColumns>(std::min(kPanelColumns, panel.width - begin), [&](auto constant) {
        constexpr int kColumns = constant();
        const double* columns = values_.data() + panel.value_begin + begin * stride;
        double top[kPanelColumns];
        Vector4 factors[kColumns];
#pragma GCC unroll 4
        for (int i = 0; i < kPanelColumns; ++i) top[i] = y[begin + i];
#pragma GCC unroll 4
        for (int j = 0; j < kColumns; ++j) {
#pragma GCC unroll 4
          for (int i = j + 1; i < kPanelColumns; ++i) top[i] -= top[j] * columns[begin + i + j * stride];
          factors[j] = _mm256_set1_pd(top[j]);
        }
#pragma GCC unroll 4
        for (int i = 0; i < kPanelColumns; ++i) y[begin + i] = top[i];
        for (int row = begin + kPanelColumns; row < stride; row += kLanes) {
          Vector4 value = _mm256_loadu_pd(y + row);
#pragma GCC unroll 4
          for (int j = 0; j < kColumns; ++j) {
            value = _mm256_fnmadd_pd(_mm256_loadu_pd(columns + row + j * stride), factors[j], value);
          }
          _mm256_storeu_pd(y + row, value);
        }
      });
    }
    std::copy_n(y, panel.width, x + panel.first);
    for (int row = 0; row < panel.below(); ++row) x[rows[row]] += y[panel.width + row];
  }
}

void BlockCholesky::backward_one(double* x, int first_panel, int end_panel) const {
  std::vector<double> scratch(static_cast<std::size_t>(most_rows_));
  double* y = scratch.data();  // the rows of a panel
  for (int p = end_panel - 1; p >= first_panel; --p) {
    const Panel& panel = panels_[p];
    const int* rows = rows_.data() + panel.row_begin;
    const long stride = panel.stride;
    for (int i = 0; i < panel.width; ++i) y[i] = x[panel.first + i] * inverse_pivots_[panel.first + i];
    for (int row = 0; row < panel.below(); ++row) y[panel.width + row] = x[rows[row]];
    std::fill(y + panel.height, y + stride, 0.0);
    for (int begin = (panel.width - 1) / kPanelColumns * kPanelColumns; begin >= 0; begin -= kPanelColumns) {
      with_constant<kPanelColumns>(std::min(kPanelColumns, panel.width - begin), [&](auto constant) {
        constexpr int kColumns = constant();
        const double* columns = values_.data() + panel.value_begin + begin * stride;
        Vector4 sums[kColumns];
#pragma GCC unroll 4
        for (int j = 0; j < kColumns; ++j) sums[j] = _mm256_setzero_pd();
        for (int row = begin + kPanelColumns; row < stride; row += kLanes) {
          const Vector4 value = _mm256_loadu_pd(y + row);
#pragma GCC unroll 4
          for (int j = 0; j < kColumns; ++j) {
            sums[j] = _mm256_fmadd_pd(_mm256_loadu_pd(columns + row + j * stride), value, sums[j]);
          }
        }
        double top[kPanelColumns];
#pragma GCC unroll 4
        for (int i = 0; i < kPanelColumns; ++i) top[i] = y[begin + i];
#pragma GCC unroll 4
        for (int j = kColumns - 1; j >= 0; --j) {
          top[j] -= sum(sums[j]);
#pragma GCC unroll 4
          for (int i = kPanelColumns - 1; i > j; --i) top[j] -= top[i] * columns[begin + i + j * stride];
        }
#pragma GCC unroll 4
        for (int j = 0; j < kColumns; ++j) y[begin + j] = top[j];
      });
    }
    std::copy_n(y, panel.width, x + panel.first);
  }
}

// Right-hand sides 0 … 4·kVectors − 1 of each degree of freedom, `count` apart: the rows of the tiles.
template <int kVectors>
void BlockCholesky::forward_columns(double* x, long count, int first_panel, int end_panel) const {
  for (int p = first_panel; p < end_panel; ++p) {
    const Panel& panel = panels_[p];
    const double* values = values_.data() + panel.value_begin;
    double* own = x + panel.first * count;
    for (int begin = 0; begin < panel.width; begin += kSolveRows) {
      with_constant<kSolveRows>(std::min(kSolveRows, panel.width - begin), [&](auto constant) {
        constexpr int kRows = constant();
        const auto place = [&](int j) { return own + (begin + j) * count; };
        const double* corner = values + begin + long(begin) * panel.stride;
        Tile<kVectors, kRows> tile;
        tile.load(place);
        tile.subtract_product(own, count, values + begin, panel.stride, 1, begin);
#pragma GCC unroll 16
        for (int i = 0; i < kRows; ++i) {
#pragma GCC unroll 16
          for (int j = i + 1; j < kRows; ++j) tile.eliminate(j, i, corner[j + i * panel.stride]);
        }
        tile.store(place);
      });
    }
    for (int begin = 0; begin < panel.below(); begin += kSolveRows) {
      with_constant<kSolveRows>(std::min(kSolveRows, panel.below() - begin), [&](auto constant) {
        const int* rows = rows_.data() + panel.row_begin + begin;
        const auto place = [&](int j) { return x + rows[j] * count; };
        Tile<kVectors, constant()> tile;
        tile.load(place);
        tile.subtract_product(own, count, values + panel.width + begin, panel.stride, 1, panel.width);
        tile.store(place);
      });
    }
  }
}

template <int kVectors>
void BlockCholesky::backward_columns(double* x, long count, int first_panel, int end_panel) const {
  constexpr int kStride = kVectors * kLanes;
  std::vector<double> gathered(static_cast<std::size_t>(kStride * most_rows_));
  for (int p = end_panel - 1; p >= first_panel; --p) {
    const Panel& panel = panels_[p];
    const double* values = values_.data() + panel.value_begin;
    const int* rows = rows_.data() + panel.row_begin;
    for (int row = 0; row < panel.below(); ++row) {
      std::copy_n(x + rows[row] * count, kStride, gathered.data() + row * kStride);
    }
    double* own = x + panel.first * count;
    for (int begin = (panel.width - 1) / kSolveRows * kSolveRows; begin >= 0; begin -= kSolveRows) {
      with_constant<kSolveRows>(std::min(kSolveRows, panel.width - begin), [&](auto constant) {
        constexpr int kRows = constant();
        const auto place = [&](int j) { return own + (begin + j) * count; };
        const double* columns = values + long(begin) * panel.stride;
        const int next = begin + kRows;
        Tile<kVectors, kRows> tile;
        tile.load(place);
        for (int i = 0; i < kRows; ++i) tile.scale(i, inverse_pivots_[panel.first + begin + i]);
        tile.subtract_product(own + next * count, count, columns + next, 1, panel.stride, panel.width - next);
        tile.subtract_product(gathered.data(), kStride, columns + panel.width, 1, panel.stride,
                              panel.below());
#pragma GCC unroll 16
        for (int i = kRows - 1; i > 0; --i) {
#pragma GCC unroll 16
          for (int j = 0; j < i; ++j) tile.eliminate(j, i, columns[begin + i + j * panel.stride]);
        }
        tile.store(place);
      });
    }
  }
}

}  // namespace vivify::sim
