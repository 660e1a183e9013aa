// The generic family: turns any measure (sim/elastic/measures/measure.h) into the kernels of MeasureFamily.
// Terms go through the kernels in blocks of as many as the scalar T has lanes.
#pragma once

#include <algorithm>
#include <array>
#include <utility>

#include "sim/elastic/measure_family.h"
#include "sim/elastic/packet.h"
#include "sim/solve/dense_product.h"

namespace vivify::sim {

template <class Measure, class T>
class FamilyOf final : public MeasureFamily {
 public:
  static constexpr int kDim = Measure::kDim;
  static constexpr int kPoints = Measure::kPoints;
  static constexpr int kSize = Measure::kSize;
  static constexpr int kComponents = Measure::kComponents;
  static constexpr int kParameters = Measure::kParameters;
  static constexpr int kLane = kLanes<T>;

  using Stencil = typename Measure::template Stencil<T>;
  using Values = typename Measure::template Values<T>;
  using Gradients = typename Measure::template Gradients<T>;
  using Hessian = typename Measure::template Hessian<T>;
  using Direction = typename Measure::template Direction<T>;
  using Parameters = typename Measure::template Parameters<T>;

  FamilyOf(std::string_view name, std::unique_ptr<Law> law) : MeasureFamily(std::move(law)), name_(name) {}

  std::string_view name() const override { return name_; }
  MeasureKind kind() const override {
    return Measure::kMeasuresSize ? MeasureKind::size
           : Measure::kPeriodic   ? MeasureKind::angle
                                  : MeasureKind::stretch;
  }
  int dimension() const override { return kDim; }
  int points_per_term() const override { return kPoints; }
  int components() const override { return kComponents; }
  int parameters() const override { return kParameters; }

  [[gnu::flatten]] void values(Side side, const Eigen::VectorXd& x, Eigen::VectorXd& s) const override {
    s.resize(kComponents * stencil_count(side));
    for (int first = 0; first < stencil_count(side); first += kLane) {
      store_values(side, Measure::template values<T>(load(side, first, x), constants(first)), first, s);
    }
    spread_to_terms(side, s);
  }

  [[gnu::flatten]] void gradients(Side side, const Eigen::VectorXd& x, Eigen::VectorXd& s,
                                  Eigen::VectorXd& g) const override {
    s.resize(kComponents * stencil_count(side));
    g.resize(blocks(side) * kGradient);
    for (int first = 0; first < stencil_count(side); first += kLane) {
      const Stencil stencil = load(side, first, x);
      const Parameters parameters = constants(first);
      store_values(side, Measure::template values<T>(stencil, parameters), first, s);
      store_gradients(Measure::template gradients<T>(stencil, parameters), first, g);
    }
    spread_to_terms(side, s);
  }

  [[gnu::flatten]] void scatter(Side side, const Eigen::VectorXd& g, const Eigen::VectorXd& w,
                                Eigen::VectorXd& out) const override {
    Eigen::VectorXd sums;
    const Eigen::VectorXd& weights = sum_terms(side, w, sums);
    for (int first = 0; first < stencil_count(side); first += kLane) {
      const Direction sum = load_gradients(first, g).lazyProduct(load_values(side, first, weights));
      for (int n = 0; n < kPoints; ++n) {
        add_lanes<kDim>(sum.data() + kDim * n, lanes(side, first),
                        [&](int k) { return out.data() + kDim * stencil_of(side, first + k)[n]; });
      }
    }
  }

  RowMatrixXd gather(Side side, const Eigen::VectorXd& g, const RowMatrixXd& Y) const override {
    const Eigen::Index columns = Y.cols();
    RowMatrixXd result(value_count(), columns);
    for (int i = 0; i < stencil_count(side); ++i) {
      const int begin = first_term(side, i), end = first_term(side, i + 1);
      double* out = result.data() + kComponents * begin * columns;
      const double* gradients = g.data() + i / kLane * kGradient + i % kLane;
      for (int c = 0; c < kComponents; ++c) {
        combine_rows<kPoints, kDim>(Y.data(), stencil_of(side, i), gradients + c * kSize * kLane, kLane,
                                    columns, out + c * columns);
      }
      for (int term = begin + 1; term < end; ++term) {
        std::copy_n(out, kComponents * columns, result.data() + kComponents * term * columns);
      }
    }
    return result;
  }

  [[gnu::flatten]] void add_hessians(const Eigen::VectorXd& x, const Eigen::VectorXd& g,
                                     const Eigen::VectorXd& a, const Eigen::VectorXd& b,
                                     SymmetricMatrix& matrix) const override {
    Eigen::VectorXd sums_a, sums_b;
    const Eigen::VectorXd& slopes = sum_terms(Side::deformed, a, sums_a);
    const Eigen::VectorXd& stresses = sum_terms(Side::deformed, b, sums_b);
    for (int first = 0; first < stencil_count(Side::deformed); first += kLane) {
      const Gradients gradients = load_gradients(first, g), scaled = scale(gradients, first, slopes);
      const Hessian H = Measure::template hessian<T>(load(Side::deformed, first, x), constants(first),
                                                     load_values(Side::deformed, first, stresses));
      add_block(first, matrix, [&](int row, int column) -> T {
        return H(row, column) + outer(gradients, row, scaled, column);
      });
    }
  }

  void hessian_products(const Eigen::VectorXd& x, const Eigen::VectorXd& l,
                        Eigen::VectorXd& Hl) const override {
    Hl.resize(blocks(Side::deformed) * kGradient);
    for (int first = 0; first < stencil_count(Side::deformed); first += kLane) {
      const Stencil stencil = load(Side::deformed, first, x);
      store_gradients(products(stencil, constants(first), load_flat(first, l)), first, Hl);
    }
  }

  void add_block_a(const Eigen::VectorXd& x, const Eigen::VectorXd& g, const Eigen::VectorXd& a,
                   const Eigen::VectorXd& b, const Eigen::VectorXd& db, const Eigen::VectorXd& l,
                   SymmetricMatrix& matrix) const override {
    Eigen::VectorXd sums_a, sums_b, sums_db;
    const Eigen::VectorXd& slopes = sum_terms(Side::deformed, a, sums_a);
    const Eigen::VectorXd& stresses = sum_terms(Side::deformed, b, sums_b);
    const Eigen::VectorXd& stress_rates = sum_terms(Side::deformed, db, sums_db);
    for (int first = 0; first < stencil_count(Side::deformed); first += kLane) {
      const Stencil stencil = load(Side::deformed, first, x);
      const Parameters parameters = constants(first);
      const Direction direction = load_flat(first, l);
      const Gradients gradients = load_gradients(first, g), rates = products(stencil, parameters, direction);
      const Gradients scaled = scale(gradients, first, slopes), scaled_rates = scale(rates, first, slopes);
      const Hessian H = Measure::template hessian<T>(stencil, parameters,
                                                     load_values(Side::deformed, first, stress_rates)) +
                        Measure::template third<T>(stencil, parameters,
                                                   load_values(Side::deformed, first, stresses), direction);
      add_block(first, matrix, [&](int row, int column) -> T {
        return H(row, column) + outer(gradients, row, scaled_rates, column) +
               outer(rates, row, scaled, column);
      });
    }
  }

  void add_rest_hessians(const Eigen::VectorXd& X, const Eigen::VectorXd& w, const RowMatrixXd& L,
                         Eigen::MatrixXd& out) const override {
    RowMatrixXd local(kSize, L.cols());
    Eigen::Matrix<double, kSize, kSize> H;
    for (int first = 0; first < size(); first += kLane) {
      const Hessian block = Measure::template hessian<T>(load(Side::rest, first, X), constants(first),
                                                         load_values(Side::rest, first, w));
      for (int k = 0; k < lanes(Side::rest, first); ++k) {
        const int* points = stencil_of(Side::rest, first + k);
        for (int r = 0; r < kSize; ++r) {
          local.row(r) = L.row(kDim * points[r / kDim] + r % kDim);
          for (int c = 0; c < kSize; ++c) H(r, c) = lane(block(r, c), k);
        }
        out.noalias() += local.transpose() * (H * local);
      }
    }
  }

 private:
  static constexpr int kGradient = kSize * kComponents * kLane;  // numbers per block

  Eigen::Index blocks(Side side) const { return (stencil_count(side) + kLane - 1) / kLane; }
  int lanes(Side side, int first) const { return std::min(kLane, stencil_count(side) - first); }

  // Lanes beyond the last stencil repeat it; what they give is not used.
  int stencil_at(Side side, int first, int k) const { return std::min(first + k, stencil_count(side) - 1); }

  Stencil load(Side side, int first, const Eigen::VectorXd& x) const {
    Stencil stencil;
    std::array<const int*, kLane> points;
    for (int k = 0; k < kLane; ++k) points[k] = stencil_of(side, stencil_at(side, first, k));
    for (int n = 0; n < kPoints; ++n) {
      std::array<const double*, kLane> point;
      for (int k = 0; k < kLane; ++k) point[k] = x.data() + kDim * points[k][n];
      for (int axis = 0; axis < kDim; ++axis) {
        stencil(axis, n) = from_lanes<T>([&](int k) { return point[k][axis]; });
      }
    }
    return stencil;
  }

  Direction load_flat(int first, const Eigen::VectorXd& x) const {
    const Stencil stencil = load(Side::deformed, first, x);
    Direction flat;
    for (int r = 0; r < kSize; ++r) flat[r] = stencil(r % kDim, r / kDim);
    return flat;
  }

  // Terms with constants have a stencil of their own on either side.
  Parameters constants(int first) const {
    Parameters parameters;
    for (int n = 0; n < kParameters; ++n) {
      parameters[n] = from_lanes<T>([&](int k) {
        return constants_[static_cast<std::size_t>(kParameters * stencil_at(Side::rest, first, k) + n)];
      });
    }
    return parameters;
  }

  // One value per component and stencil.
  Values load_values(Side side, int first, const Eigen::VectorXd& s) const {
    Values values;
    for (int c = 0; c < kComponents; ++c) {
      values[c] = from_lanes<T>([&](int k) { return s[kComponents * stencil_at(side, first, k) + c]; });
    }
    return values;
  }
  void store_values(Side side, const Values& values, int first, Eigen::VectorXd& s) const {
    for (int c = 0; c < kComponents; ++c) {
      for (int k = 0; k < lanes(side, first); ++k) s[kComponents * (first + k) + c] = lane(values[c], k);
    }
  }

  // Gradients of a block lie together: component by component, coordinate by coordinate, lane by lane.
  Gradients load_gradients(int first, const Eigen::VectorXd& g) const {
    Gradients gradients;
    const double* from = g.data() + first / kLane * kGradient;
    for (int n = 0; n < kSize * kComponents; ++n, from += kLane) load_lanes(gradients.data()[n], from);
    return gradients;
  }
  void store_gradients(const Gradients& gradients, int first, Eigen::VectorXd& g) const {
    double* to = g.data() + first / kLane * kGradient;
    for (int n = 0; n < kSize * kComponents; ++n, to += kLane) store_lanes(gradients.data()[n], to);
  }

  static Gradients products(const Stencil& stencil, const Parameters& parameters, const Direction& l) {
    Gradients result;
    for (int c = 0; c < kComponents; ++c) {
      result.col(c) = Measure::template hessian<T>(stencil, parameters, Values::Unit(c)).lazyProduct(l);
    }
    return result;
  }

  // Column k of the result is Σ a_kl g_l over the components of a stencil.
  Gradients scale(const Gradients& g, int first, const Eigen::VectorXd& a) const {
    Gradients scaled;
    if (a.size() == kComponents * stencil_count(Side::deformed)) {
      const Values weights = load_values(Side::deformed, first, a);
      for (int k = 0; k < kComponents; ++k) scaled.col(k) = g.col(k) * weights[k];
      return scaled;
    }
    scaled.setZero();
    for (int k = 0; k < kComponents; ++k) {
      for (int l = 0; l < kComponents; ++l) {
        const T weight = from_lanes<T>([&](int lane) {
          return a[kComponents * (kComponents * stencil_at(Side::deformed, first, lane) + k) + l];
        });
        scaled.col(k) += g.col(l) * weight;
      }
    }
    return scaled;
  }
  // Entry of Σ g_k h_kᵀ.
  static T outer(const Gradients& g, int row, const Gradients& h, int column) {
    T sum = g(row, 0) * h(column, 0);
    for (int k = 1; k < kComponents; ++k) sum += g(row, k) * h(column, k);
    return sum;
  }

  // Adds the lower triangle of the blocks of all lanes to the matrix, one column of a pair of points at a
  // time.
  template <class Entry>
  void add_block(int first, SymmetricMatrix& matrix, const Entry& entry) const {
    static constexpr int kPairs = kPoints * (kPoints + 1) / 2;
    const int* columns = columns_.data() + kPairs * kDim * first;
    const auto add_column = [&](auto rows, int column, const T* entries) {
      add_lanes<rows()>(entries, lanes(Side::deformed, first),
                        [&](int k) { return matrix.values() + columns[kPairs * kDim * k + column]; });
    };
    int pair = 0;
#pragma GCC unroll 4
    for (int a = 0; a < kPoints; ++a) {
#pragma GCC unroll 4
      for (int b = 0; b < a; ++b, ++pair) {
        const T turned = from_lanes<T>([&](int k) {
          return turned_[static_cast<std::size_t>(kPairs * stencil_at(Side::deformed, first, k) + pair)];
        });
        Eigen::Matrix<T, kDim, kDim> block;
        for (int j = 0; j < kDim; ++j) {
          for (int i = 0; i < kDim; ++i) block(i, j) = entry(kDim * a + i, kDim * b + j);
        }
        for (int j = 0; j < kDim; ++j) {
          std::array<T, kDim> column;
          for (int i = 0; i < kDim; ++i) column[i] = select(turned, block(j, i), block(i, j));
          add_column(std::integral_constant<int, kDim>(), kDim * pair + j, column.data());
        }
      }
      [&]<int... j>(std::integer_sequence<int, j...>) {
        const auto add_diagonal = [&](auto rows) {
          std::array<T, rows()> column;
          constexpr int kColumn = kDim - rows();
          for (int i = 0; i < rows(); ++i) column[i] = entry(kDim * a + kColumn + i, kDim * a + kColumn);
          add_column(rows, kDim * pair + kColumn, column.data());
        };
        (add_diagonal(std::integral_constant<int, kDim - j>()), ...);
      }
      (std::make_integer_sequence<int, kDim>());
      ++pair;
    }
  }

  // `yes` where the flag is not zero.
  static T select(const T& flag, const T& yes, const T& no) {
    if constexpr (kLane == 1) {
      return flag != 0 ? yes : no;
    } else {
      T result = no;
      where(flag != T(0.0), result) = yes;
      return result;
    }
  }

  static void load_lanes(double& value, const double* from) { value = *from; }
  static void store_lanes(double value, double* to) { *to = value; }
  static void load_lanes(Packet& value, const double* from) {
    value.copy_from(from, std::experimental::vector_aligned);
  }
  static void store_lanes(const Packet& value, double* to) {
    value.copy_to(to, std::experimental::vector_aligned);
  }

  std::string_view name_;
};

template <class Measure>
std::unique_ptr<MeasureFamily> family_of(std::string_view name, Kernels kernels, std::unique_ptr<Law> law) {
  if (kernels == Kernels::scalar) return std::make_unique<FamilyOf<Measure, double>>(name, std::move(law));
  return std::make_unique<FamilyOf<Measure, Packet>>(name, std::move(law));
}

// A family with the quadratic law.
template <class Measure>
std::unique_ptr<MeasureFamily> quadratic_family(std::string_view name, Kernels kernels) {
  return family_of<Measure>(name, kernels, make_quadratic_law(Measure::kComponents, Measure::kPeriodic));
}

std::unique_ptr<MeasureFamily> make_edge_length_2d(Kernels);
std::unique_ptr<MeasureFamily> make_edge_length_3d(Kernels);
std::unique_ptr<MeasureFamily> make_area(Kernels);
std::unique_ptr<MeasureFamily> make_volume(Kernels);
std::unique_ptr<MeasureFamily> make_green_strain_2d(Kernels);
std::unique_ptr<MeasureFamily> make_green_strain_3d(Kernels);
std::unique_ptr<MeasureFamily> make_printed_green_strain(Kernels);
std::unique_ptr<MeasureFamily> make_turning_angle(Kernels);
std::unique_ptr<MeasureFamily> make_dihedral_angle(Kernels);

}  // namespace vivify::sim
