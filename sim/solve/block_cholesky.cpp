#include "sim/solve/block_cholesky.h"

#include <immintrin.h>

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace vivify::sim {
namespace {

// ---- Symbolic part: on the graph of vertices ----

using Graph = std::vector<std::vector<int>>;  // neighbours of every vertex, sorted, without itself

Graph vertex_graph(const Eigen::SparseMatrix<double>& lower, int dim) {
  Graph graph(static_cast<std::size_t>(lower.cols() / dim));
  for (int column = 0; column < lower.cols(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(lower, column); it; ++it) {
      const int a = static_cast<int>(it.row()) / dim, b = column / dim;
      if (a == b) continue;
      graph[a].push_back(b);
      graph[b].push_back(a);
    }
  }
  for (std::vector<int>& neighbours : graph) {
    std::sort(neighbours.begin(), neighbours.end());
    neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
  }
  return graph;
}

// Vertices in the order of elimination by approximate minimum degree.
std::vector<int> minimum_degree_order(const Graph& graph) {
  const int count = static_cast<int>(graph.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (int v = 0; v < count; ++v) {
    entries.emplace_back(v, v, 1.0);
    for (const int u : graph[v]) entries.emplace_back(u, v, 1.0);
  }
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(matrix, order);
  return {order.indices().data(), order.indices().data() + count};
}

// Columns of L that are eliminated together, in vertices. rows: those below the columns.
struct Front {
  std::vector<int> columns, rows, children;
};

// The elimination tree with the rows of every column of L; vertices are numbered by their order of
// elimination.
std::vector<Front> elimination_tree(const Graph& graph, const std::vector<int>& order) {
  const int count = static_cast<int>(graph.size());
  std::vector<int> position(graph.size()), seen(graph.size(), -1);
  for (int i = 0; i < count; ++i) position[order[i]] = i;
  std::vector<Front> fronts(graph.size());
  for (int j = 0; j < count; ++j) {
    Front& front = fronts[j];
    front.columns = {j};
    seen[j] = j;
    const auto add = [&](int row) {
      if (row <= j || seen[row] == j) return;
      seen[row] = j;
      front.rows.push_back(row);
    };
    for (const int neighbour : graph[order[j]]) add(position[neighbour]);
    for (const int child : front.children)
      std::for_each(fronts[child].rows.begin(), fronts[child].rows.end(), add);
    std::sort(front.rows.begin(), front.rows.end());
    if (!front.rows.empty()) fronts[front.rows.front()].children.push_back(j);
  }
  return fronts;
}

double factor_flops(double width, double below) {
  return width * width * width / 3 + width * width * below + width * below * below;
}

// Estimated time of a front in cycles: of its handling, of writing and reading its entries, of the products,
// and of adding the update of the rows below to other fronts.
double front_cost(double width, double below) {
  constexpr double kHandling = 400, kEntry = 1.5, kFlop = 1.0 / 8, kScatter = 0.5;
  return kHandling + kEntry * width * (width + below) + kFlop * factor_flops(width, below) +
         kScatter * below * below;
}

// Merges fronts into their parents wherever that is estimated to save time. Returns the fronts that are left
// in the order of elimination, columns and rows in the old numbers.
std::vector<Front> merge_fronts(std::vector<Front> fronts, int dim) {
  const auto cost = [&](std::size_t width, std::size_t below) {
    return front_cost(static_cast<double>(width) * dim, static_cast<double>(below) * dim);
  };
  std::vector<int> roots;
  for (std::size_t p = 0; p < fronts.size(); ++p) {
    Front& parent = fronts[p];
    for (;;) {
      std::size_t best = parent.children.size();
      double best_gain = 0;
      const double parent_cost = cost(parent.columns.size(), parent.rows.size());
      for (std::size_t i = 0; i < parent.children.size(); ++i) {
        const Front& child = fronts[parent.children[i]];
        const double gain = parent_cost + cost(child.columns.size(), child.rows.size()) -
                            cost(parent.columns.size() + child.columns.size(), parent.rows.size());
        if (gain > best_gain) {
          best_gain = gain;
          best = i;
        }
      }
      if (best == parent.children.size()) break;
      Front& child = fronts[parent.children[best]];
      parent.children.erase(parent.children.begin() + static_cast<long>(best));
      parent.children.insert(parent.children.end(), child.children.begin(), child.children.end());
      child.columns.insert(child.columns.end(), parent.columns.begin(), parent.columns.end());
      parent.columns = std::move(child.columns);
      child = {};
    }
    if (parent.rows.empty()) roots.push_back(static_cast<int>(p));
  }
  std::vector<Front> ordered;
  std::vector<std::pair<int, std::size_t>> path;  // front and its next child
  for (const int root : roots) {
    path.emplace_back(root, 0);
    while (!path.empty()) {
      const auto [front, child] = path.back();
      if (child < fronts[front].children.size()) {
        ++path.back().second;
        path.emplace_back(fronts[front].children[child], 0);
      } else {
        ordered.push_back(std::move(fronts[front]));
        path.pop_back();
      }
    }
  }
  return ordered;
}

// ---- Dense kernels ----

using Vector = __m256d;
constexpr int kLanes = 4;
constexpr int kSlack = 16;  // entries that a kernel may read or write behind an array

int round_up(int count, int multiple) { return (count + multiple - 1) / multiple * multiple; }

// kVectors·4 rows by kColumns columns in registers.
template <int kVectors, int kColumns>
struct Tile {
  Vector at[kColumns][kVectors];

  void set_zero() {
#pragma GCC unroll 16
    for (int j = 0; j < kColumns; ++j) {
#pragma GCC unroll 16
      for (int i = 0; i < kVectors; ++i) at[j][i] = _mm256_setzero_pd();
    }
  }
  void load(const double* from, long stride) {
#pragma GCC unroll 16
    for (int j = 0; j < kColumns; ++j) {
#pragma GCC unroll 16
      for (int i = 0; i < kVectors; ++i) at[j][i] = _mm256_loadu_pd(from + j * stride + kLanes * i);
    }
  }
  void store(double* to, long stride) const {
#pragma GCC unroll 16
    for (int j = 0; j < kColumns; ++j) {
#pragma GCC unroll 16
      for (int i = 0; i < kVectors; ++i) _mm256_storeu_pd(to + j * stride + kLanes * i, at[j][i]);
    }
  }
  // Subtracts A B: A has `depth` columns `stride` apart, entry (k, j) of B is b[k·next_row + j·next_column].
  void subtract_product(const double* a, long stride, const double* b, long next_row, long next_column,
                        int depth) {
    for (int k = 0; k < depth; ++k, a += stride, b += next_row) {
      Vector column[kVectors];
#pragma GCC unroll 16
      for (int i = 0; i < kVectors; ++i) column[i] = _mm256_loadu_pd(a + kLanes * i);
#pragma GCC unroll 16
      for (int j = 0; j < kColumns; ++j) {
        const Vector factor = _mm256_broadcast_sd(b + j * next_column);
#pragma GCC unroll 16
        for (int i = 0; i < kVectors; ++i) at[j][i] = _mm256_fnmadd_pd(column[i], factor, at[j][i]);
      }
    }
  }
  // Subtracts factor times column `from` from column `to`.
  void eliminate(int to, int from, double factor) {
    const Vector factors = _mm256_set1_pd(factor);
#pragma GCC unroll 16
    for (int i = 0; i < kVectors; ++i) at[to][i] = _mm256_fnmadd_pd(at[from][i], factors, at[to][i]);
  }
  void scale(int column, double factor) {
    const Vector factors = _mm256_set1_pd(factor);
#pragma GCC unroll 16
    for (int i = 0; i < kVectors; ++i) at[column][i] = _mm256_mul_pd(at[column][i], factors);
  }
};

// Calls with std::integral_constant<int, n> for 1 <= n <= kMost.
template <int kMost, typename Call>
decltype(auto) with_constant(int n, const Call& call) {
  if constexpr (kMost > 1) {
    if (n < kMost) return with_constant<kMost - 1>(n, call);
  }
  return call(std::integral_constant<int, kMost>());
}

double sum(Vector v) {
  const __m128d half = _mm_add_pd(_mm256_castpd256_pd128(v), _mm256_extractf128_pd(v, 1));
  return _mm_cvtsd_f64(_mm_add_sd(half, _mm_unpackhi_pd(half, half)));
}

// Adds `count` entries; may add zeros to the next three.
void add(double* to, const double* from, int count) {
  for (; count >= kLanes; count -= kLanes, to += kLanes, from += kLanes) {
    _mm256_storeu_pd(to, _mm256_add_pd(_mm256_loadu_pd(to), _mm256_loadu_pd(from)));
  }
  if (count == 0) return;
  alignas(32) static constexpr long kMasks[2 * kLanes] = {-1, -1, -1, -1, 0, 0, 0, 0};
  const __m256i mask = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(kMasks + kLanes - count));
  const Vector kept = _mm256_and_pd(_mm256_loadu_pd(from), _mm256_castsi256_pd(mask));
  _mm256_storeu_pd(to, _mm256_add_pd(_mm256_loadu_pd(to), kept));
}

// Columns of a panel that are eliminated at once, rows and columns of one step of an update, and of a
// solution with many right-hand sides.
constexpr int kPanelColumns = 4;
constexpr int kUpdateColumns = 6;
constexpr int kSolveRows = 4;

// Rows `row` … of the columns of a step of a panel.
template <int kVectors, int kColumns>
void eliminate_rows(double* columns, const double* panel, long stride, int depth, const double* packed,
                    int row, const double (&corner)[kColumns][kPanelColumns], const double* inverse_pivots) {
  Tile<kVectors, kColumns> tile;
  tile.load(columns + row, stride);
  tile.subtract_product(panel + row, stride, packed, kColumns, 1, depth);
#pragma GCC unroll 16
  for (int i = 0; i < kColumns; ++i) {
#pragma GCC unroll 16
    for (int j = i + 1; j < kColumns; ++j) tile.eliminate(j, i, corner[i][j]);
  }
#pragma GCC unroll 16
  for (int i = 0; i < kColumns; ++i) tile.scale(i, inverse_pivots[i]);
  tile.store(columns + row, stride);
}

// Columns begin … begin + kColumns − 1 of a panel whose earlier columns are done. False when it ends at a
// pivot.
template <int kColumns, bool kToTheEnd>
bool eliminate_columns(double* panel, int stride, int begin, double* packed, double* pivots,
                       double* inverse_pivots) {
  for (int k = 0; k < begin; ++k) {
    for (int j = 0; j < kColumns; ++j)
      packed[k * kColumns + j] = panel[begin + j + long(k) * stride] * pivots[k];
  }
  double* columns = panel + long(begin) * stride;
  Tile<1, kColumns> tile;
  tile.load(columns + begin, stride);
  tile.subtract_product(panel + begin, stride, packed, kColumns, 1, begin);
  double product[kColumns][kPanelColumns], corner[kColumns][kPanelColumns];
  tile.store(&product[0][0], kPanelColumns);
  for (int i = 0; i < kColumns; ++i) {
    const double pivot = product[i][i];
    const bool usable = kToTheEnd ? pivot != 0 : pivot > 0 && std::isfinite(pivot);
    if (!kToTheEnd && !usable) return false;
    pivots[begin + i] = pivot;
    const double inverse = usable ? 1 / pivot : 0;
    inverse_pivots[begin + i] = inverse;
    for (int row = i + 1; row < kPanelColumns; ++row) {
      corner[i][row] = product[i][row] * inverse;
      columns[begin + row + long(i) * stride] = corner[i][row];
    }
    for (int j = i + 1; j < kColumns; ++j) {
      for (int row = j; row < kPanelColumns; ++row) product[j][row] -= product[i][row] * corner[i][j];
    }
  }
  int row = begin + kPanelColumns;
  for (; row + 3 * kLanes <= stride; row += 3 * kLanes) {
    eliminate_rows<3>(columns, panel, stride, begin, packed, row, corner, inverse_pivots + begin);
  }
  if (row + 2 * kLanes <= stride) {
    eliminate_rows<2>(columns, panel, stride, begin, packed, row, corner, inverse_pivots + begin);
  } else if (row < stride) {
    eliminate_rows<1>(columns, panel, stride, begin, packed, row, corner, inverse_pivots + begin);
  }
  return true;
}

}  // namespace

// ---- Panels ----

BlockCholesky::BlockCholesky(const Eigen::SparseMatrix<double>& lower, int dim)
    : dim_(dim), size_(static_cast<int>(lower.cols())) {
  make_panels(lower);
  make_targets();
}

void BlockCholesky::make_panels(const Eigen::SparseMatrix<double>& lower) {
  const Graph graph = vertex_graph(lower, dim_);
  const std::vector<int> order = minimum_degree_order(graph);
  const std::vector<Front> fronts = merge_fronts(elimination_tree(graph, order), dim_);

  std::vector<int> renumbered(graph.size());  // from the order of minimum degree to the final one
  std::vector<int> panel_of(graph.size());
  position_.resize(graph.size());
  int next = 0;
  for (const Front& front : fronts) {
    for (const int vertex : front.columns) {
      panel_of[next] = static_cast<int>(&front - fronts.data());
      position_[order[vertex]] = next;
      renumbered[vertex] = next++;
    }
  }
  long values = 0;
  int first = 0, most_entries = 0, most_width = 0;
  for (const Front& front : fronts) {
    std::vector<int> below;
    for (const int row : front.rows) below.push_back(renumbered[row]);
    std::sort(below.begin(), below.end());
    const int width = dim_ * static_cast<int>(front.columns.size());
    const int height = width + dim_ * static_cast<int>(below.size());
    panels_.push_back(
        {first, width, height, round_up(height, kLanes), static_cast<int>(rows_.size()), values});
    for (const int vertex : below) {
      for (int i = 0; i < dim_; ++i) rows_.push_back(dim_ * vertex + i);
    }
    first += width;
    values += long(panels_.back().stride) * width;
    most_entries = std::max(most_entries, panels_.back().stride);
    most_width = std::max(most_width, width);
    nonzeros_ += long(width) * (width + 1) / 2 + long(width) * (height - width);
    flops_ += factor_flops(width, height - width);
  }
  values_.assign(static_cast<std::size_t>(values + kSlack), 0);
  pivots_.resize(static_cast<std::size_t>(size_));
  inverse_pivots_.resize(static_cast<std::size_t>(size_));
  packed_.resize(static_cast<std::size_t>(kUpdateColumns * most_width));
  product_.resize(static_cast<std::size_t>(kUpdateColumns * (most_entries + kSlack)));

  // Place of every value: the entry of the lower triangle after reordering.
  slots_.reserve(static_cast<std::size_t>(lower.nonZeros()));
  for (int column = 0; column < size_; ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(lower, column); it; ++it) {
      const int a = dim_ * position_[it.row() / dim_] + static_cast<int>(it.row()) % dim_;
      const int b = dim_ * position_[column / dim_] + column % dim_;
      const int from = std::min(a, b), to = std::max(a, b);
      const Panel& panel = panels_[panel_of[from / dim_]];
      int row = to - panel.first;
      if (row >= panel.width) {
        const auto begin = rows_.begin() + panel.row_begin, end = begin + (panel.height - panel.width);
        row = panel.width + static_cast<int>(std::lower_bound(begin, end, to) - begin);
      }
      slots_.push_back(panel.value_begin + long(from - panel.first) * panel.stride + row);
    }
  }
}

void BlockCholesky::make_targets() {
  std::vector<int> panel_of(position_.size());
  for (const Panel& panel : panels_) {
    for (int column = 0; column < panel.width; column += dim_) {
      panel_of[(panel.first + column) / dim_] = static_cast<int>(&panel - panels_.data());
    }
  }
  for (const Panel& panel : panels_) {
    const int below = panel.height - panel.width;
    const int* rows = rows_.data() + panel.row_begin;
    for (int i = 0; i < below;) {
      const Panel& target = panels_[panel_of[rows[i] / dim_]];
      const int* target_rows = rows_.data() + target.row_begin;
      const int* target_end = target_rows + (target.height - target.width);
      const int* found = target_rows;
      int run = static_cast<int>(runs_.size());
      for (int j = i; j < below; j += dim_) {
        int place = rows[j] - target.first;
        if (place >= target.width) {
          found = std::lower_bound(found, target_end, rows[j]);
          place = target.width + static_cast<int>(found - target_rows);
        }
        if (j == i || runs_.back().shift != place - j) runs_.push_back({j, j, place - j});
        runs_.back().end += dim_;
      }
      for (; i < below && rows[i] < target.first + target.width; i += dim_) {
        while (runs_[run].end <= i) ++run;
        targets_.push_back({target.value_begin + long(rows[i] - target.first) * target.stride, target.stride, run,
                            static_cast<int>(runs_.size())});
      }
    }
  }
}

// ---- Factorisation ----

template <bool kToTheEnd>
bool BlockCholesky::factorize_panel(const Panel& panel) {
  double* values = values_.data() + panel.value_begin;
  for (int begin = 0; begin < panel.width; begin += kPanelColumns) {
    const bool done =
        with_constant<kPanelColumns>(std::min(kPanelColumns, panel.width - begin), [&](auto columns) {
          return eliminate_columns<columns(), kToTheEnd>(values, panel.stride, begin, packed_.data(),
                                                         pivots_.data() + panel.first,
                                                         inverse_pivots_.data() + panel.first);
        });
    if (!done) return false;
  }
  return true;
}

// Subtracts L D Lᵀ of the rows below a panel from the panels of those rows.
void BlockCholesky::update_targets(const Panel& panel) {
  const int below = panel.height - panel.width;
  const double* rows = values_.data() + panel.value_begin + panel.width;
  const double* pivots = pivots_.data() + panel.first;
  for (int begin = 0; begin < below; begin += kUpdateColumns) {
    const int columns = std::min(kUpdateColumns, below - begin);
    const int count = below - begin, stride = round_up(count, 2 * kLanes);
    double* product = product_.data();
    double* packed = packed_.data();
    with_constant<kUpdateColumns>(columns, [&](auto constant) {
      constexpr int kColumns = constant();
      for (int k = 0; k < panel.width; ++k) {
        const double* from = rows + begin + long(k) * panel.stride;
        for (int j = 0; j < kColumns; ++j) packed[k * kColumns + j] = from[j] * pivots[k];
      }
      const auto multiply = [&](auto vectors, int row) {
        Tile<vectors(), kColumns> tile;
        tile.set_zero();
        tile.subtract_product(rows + begin + row, panel.stride, packed, kColumns, 1, panel.width);
        tile.store(product + row, stride);
      };
      int row = 0;
      for (; row + kLanes < count; row += 2 * kLanes) multiply(std::integral_constant<int, 2>(), row);
      if (row < count) multiply(std::integral_constant<int, 1>(), row);
    });
    for (int column = 0; column < columns; column += dim_) {
      const int first = begin + column;
      const Target& target = targets_[(panel.row_begin + first) / dim_];
      double* to = values_.data() + target.column;
      const double* from = product + long(column) * stride - begin;
      for (const Run* run = runs_.data() + target.first_run; run != runs_.data() + target.last_run; ++run) {
        const int row = std::max(run->begin, first);
        for (int i = 0; i < dim_; ++i) {
          add(to + long(i) * target.stride + row + run->shift, from + long(i) * stride + row, run->end - row);
        }
      }
    }
  }
}

template <bool kToTheEnd>
bool BlockCholesky::factorize(const double* values) {
  std::fill(values_.begin(), values_.end(), 0);
  for (const long slot : slots_) values_[slot] = *values++;
  for (const Panel& panel : panels_) {
    if (!factorize_panel<kToTheEnd>(panel)) return false;
    update_targets(panel);
  }
  return true;
}

bool BlockCholesky::factorize(const double* values) { return factorize<false>(values); }

BlockCholesky::Inertia BlockCholesky::inertia(const double* values) {
  factorize<true>(values);
  Inertia result;
  for (const double pivot : pivots_)
    ++(pivot < 0 ? result.negative : pivot > 0 ? result.positive : result.zero);
  return result;
}

// ---- Solution ----

void BlockCholesky::solve_in_place(Eigen::Ref<Eigen::MatrixXd> x) const {
  const int count = static_cast<int>(x.cols()), stride = count == 1 ? 1 : round_up(count, kLanes);
  // Right-hand sides of one degree of freedom beside each other, in the order of elimination.
  std::vector<double> ordered(static_cast<std::size_t>(stride) * static_cast<std::size_t>(size_) + kSlack,
                              0.0);
  const auto each = [&](const auto& call) {
    for (int column = 0; column < count; ++column) {
      for (int row = 0; row < size_; row += dim_) {
        const int place = dim_ * position_[row / dim_];
        for (int i = 0; i < dim_; ++i) call(x(row + i, column), ordered[long(place + i) * stride + column]);
      }
    }
  };
  each([](double in, double& out) { out = in; });
  if (count == 1) {
    solve_one(ordered.data());
  } else {
    solve_many(ordered.data(), stride);
  }
  each([](double& out, double in) { out = in; });
}

void BlockCholesky::solve_one(double* x) const {
  std::vector<double> scratch(product_.size());
  double* y = scratch.data();
  for (const Panel& panel : panels_) {
    const double* columns = values_.data() + panel.value_begin;
    const int* rows = rows_.data() + panel.row_begin;
    std::copy_n(x + panel.first, panel.width, y);
    std::fill(y + panel.width, y + panel.stride, 0.0);
    for (int begin = 0; begin < panel.width;
         begin += kPanelColumns, columns += kPanelColumns * long(panel.stride)) {
      with_constant<kPanelColumns>(std::min(kPanelColumns, panel.width - begin), [&](auto constant) {
        constexpr int kColumns = constant();
        for (int j = 0; j < kColumns; ++j) {
          for (int row = j + 1; row < kPanelColumns; ++row) {
            y[begin + row] -= y[begin + j] * columns[begin + row + j * panel.stride];
          }
        }
        Vector factors[kColumns];
        for (int j = 0; j < kColumns; ++j) factors[j] = _mm256_broadcast_sd(y + begin + j);
        for (int row = begin + kPanelColumns; row < panel.stride; row += kLanes) {
          Vector value = _mm256_loadu_pd(y + row);
          for (int j = 0; j < kColumns; ++j) {
            value = _mm256_fnmadd_pd(_mm256_loadu_pd(columns + row + j * panel.stride), factors[j], value);
          }
          _mm256_storeu_pd(y + row, value);
        }
      });
    }
    std::copy_n(y, panel.width, x + panel.first);
    for (int row = panel.width; row < panel.height; ++row) x[rows[row - panel.width]] += y[row];
  }
  for (auto panel = panels_.rbegin(); panel != panels_.rend(); ++panel) {
    const int* rows = rows_.data() + panel->row_begin;
    for (int i = 0; i < panel->width; ++i) y[i] = x[panel->first + i] * inverse_pivots_[panel->first + i];
    for (int row = panel->width; row < panel->height; ++row) y[row] = x[rows[row - panel->width]];
    std::fill(y + panel->height, y + panel->stride, 0.0);
    for (int begin = (panel->width - 1) / kPanelColumns * kPanelColumns; begin >= 0; begin -= kPanelColumns) {
      const double* columns = values_.data() + panel->value_begin + long(begin) * panel->stride;
      with_constant<kPanelColumns>(std::min(kPanelColumns, panel->width - begin), [&](auto constant) {
        constexpr int kColumns = constant();
        Vector sums[kColumns];
        for (int j = 0; j < kColumns; ++j) sums[j] = _mm256_setzero_pd();
        for (int row = begin + kPanelColumns; row < panel->stride; row += kLanes) {
          const Vector value = _mm256_loadu_pd(y + row);
          for (int j = 0; j < kColumns; ++j) {
            sums[j] = _mm256_fmadd_pd(_mm256_loadu_pd(columns + row + j * panel->stride), value, sums[j]);
          }
        }
        for (int j = kColumns - 1; j >= 0; --j) {
          double value = y[begin + j] - sum(sums[j]);
          for (int row = j + 1; row < kPanelColumns; ++row) {
            value -= y[begin + row] * columns[begin + row + j * panel->stride];
          }
          y[begin + j] = value;
        }
      });
    }
    std::copy_n(y, panel->width, x + panel->first);
  }
}

void BlockCholesky::solve_many(double* x, int count) const {
  std::vector<double> gathered(3 * kLanes * product_.size() / kUpdateColumns);
  // Columns of 4 to 12 right-hand sides: the rows of the tiles.
  const auto solve_columns = [&](auto constant, int column) {
    constexpr int kVectors = constant(), kStride = kVectors * kLanes;
    for (const Panel& panel : panels_) {
      const double* values = values_.data() + panel.value_begin;
      const int* rows = rows_.data() + panel.row_begin;
      double* own = x + long(panel.first) * count + column;
      for (int begin = 0; begin < panel.width; begin += kSolveRows) {
        with_constant<kSolveRows>(std::min(kSolveRows, panel.width - begin), [&](auto rows_at_once) {
          constexpr int kRows = rows_at_once();
          Tile<kVectors, kRows> tile;
          tile.load(own + long(begin) * count, count);
          tile.subtract_product(own, count, values + begin, panel.stride, 1, begin);
          const double* corner = values + begin + long(begin) * panel.stride;
#pragma GCC unroll 16
          for (int i = 0; i < kRows; ++i) {
#pragma GCC unroll 16
            for (int j = i + 1; j < kRows; ++j) tile.eliminate(j, i, corner[j + i * panel.stride]);
          }
          tile.store(own + long(begin) * count, count);
        });
      }
      for (int begin = panel.width; begin < panel.height; begin += kSolveRows) {
        with_constant<kSolveRows>(std::min(kSolveRows, panel.height - begin), [&](auto rows_at_once) {
          constexpr int kRows = rows_at_once();
          Tile<kVectors, kRows> tile;
#pragma GCC unroll 16
          for (int j = 0; j < kRows; ++j) {
            const double* from = x + long(rows[begin - panel.width + j]) * count + column;
#pragma GCC unroll 16
            for (int i = 0; i < kVectors; ++i) tile.at[j][i] = _mm256_loadu_pd(from + kLanes * i);
          }
          tile.subtract_product(own, count, values + begin, panel.stride, 1, panel.width);
#pragma GCC unroll 16
          for (int j = 0; j < kRows; ++j) {
            double* to = x + long(rows[begin - panel.width + j]) * count + column;
#pragma GCC unroll 16
            for (int i = 0; i < kVectors; ++i) _mm256_storeu_pd(to + kLanes * i, tile.at[j][i]);
          }
        });
      }
    }
    for (auto panel = panels_.rbegin(); panel != panels_.rend(); ++panel) {
      const double* values = values_.data() + panel->value_begin;
      const int* rows = rows_.data() + panel->row_begin;
      const int below = panel->height - panel->width;
      for (int row = 0; row < below; ++row) {
        const double* from = x + long(rows[row]) * count + column;
        for (int i = 0; i < kVectors; ++i) {
          _mm256_storeu_pd(gathered.data() + row * kStride + kLanes * i, _mm256_loadu_pd(from + kLanes * i));
        }
      }
      double* own = x + long(panel->first) * count + column;
      for (int begin = (panel->width - 1) / kSolveRows * kSolveRows; begin >= 0; begin -= kSolveRows) {
        with_constant<kSolveRows>(std::min(kSolveRows, panel->width - begin), [&](auto rows_at_once) {
          constexpr int kRows = rows_at_once();
          Tile<kVectors, kRows> tile;
          tile.load(own + long(begin) * count, count);
          for (int i = 0; i < kRows; ++i) tile.scale(i, inverse_pivots_[panel->first + begin + i]);
          const double* columns = values + long(begin) * panel->stride;
          const int next = begin + kRows;
          tile.subtract_product(own + long(next) * count, count, columns + next, 1, panel->stride,
                                panel->width - next);
          tile.subtract_product(gathered.data(), kStride, columns + panel->width, 1, panel->stride, below);
#pragma GCC unroll 16
          for (int i = kRows - 1; i >= 0; --i) {
#pragma GCC unroll 16
            for (int j = 0; j < i; ++j) tile.eliminate(j, i, columns[begin + i + j * panel->stride]);
          }
          tile.store(own + long(begin) * count, count);
        });
      }
    }
  };
  for (int column = 0; column < count; column += 3 * kLanes) {
    with_constant<3>(std::min(3, (count - column) / kLanes),
                     [&](auto vectors) { solve_columns(vectors, column); });
  }
}

}  // namespace vivify::sim
