// The generic family: turns any measure (sim/elastic/measures/measure.h) into the kernels of MeasureFamily.
// Terms go through the kernels in blocks of as many as the scalar T has lanes.
#pragma once

#include <algorithm>
#include <array>

#include "sim/elastic/measure_family.h"
#include "sim/elastic/packet.h"

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

  void values(Side side, const Eigen::VectorXd& x, Eigen::VectorXd& s) const override {
    s.resize(value_count());
    for (int first = 0; first < size(); first += kLane) {
      store_values(Measure::template values<T>(load(side, first, x), constants(first)), first, s);
    }
  }

  void gradients(Side side, const Eigen::VectorXd& x, Eigen::VectorXd& s, Eigen::VectorXd& g) const override {
    s.resize(value_count());
    g.resize(blocks() * kGradient);
    for (int first = 0; first < size(); first += kLane) {
      const Stencil stencil = load(side, first, x);
      const Parameters parameters = constants(first);
      store_values(Measure::template values<T>(stencil, parameters), first, s);
      store_gradients(Measure::template gradients<T>(stencil, parameters), first, g);
    }
  }

  void scatter(Side side, const Eigen::VectorXd& g, const Eigen::VectorXd& w,
               Eigen::VectorXd& out) const override {
    for (int first = 0; first < size(); first += kLane) {
      const Direction sum = load_gradients(first, g).lazyProduct(load_values(first, w));
      for (int k = 0; k < lanes(first); ++k) {
        const int* points = stencil_of(side, first + k);
        for (int r = 0; r < kSize; ++r) out[kDim * points[r / kDim] + r % kDim] += lane(sum[r], k);
      }
    }
  }

  RowMatrixXd gather(Side side, const Eigen::VectorXd& g, const RowMatrixXd& Y) const override {
    const Eigen::Index columns = Y.cols();
    RowMatrixXd result(value_count(), columns);
    std::array<const double*, kSize> rows;
    std::array<double, kSize> weights;
    for (int i = 0; i < size(); ++i) {
      const int* points = stencil_of(side, i);
      for (int r = 0; r < kSize; ++r) rows[r] = Y.data() + (kDim * points[r / kDim] + r % kDim) * columns;
      for (int c = 0; c < kComponents; ++c) {
        for (int r = 0; r < kSize; ++r) weights[r] = gradient_entry(g, i, c, r);
        double* out = result.data() + (kComponents * i + c) * columns;
        Eigen::Index column = 0;
        for (; column + 2 * kLane <= columns; column += 2 * kLane) {
          combine<2>(rows, weights, column, out);
        }
        for (; column + kLane <= columns; column += kLane) combine<1>(rows, weights, column, out);
        for (; column < columns; ++column) {
          double sum = 0;
          for (int r = 0; r < kSize; ++r) sum += weights[r] * rows[r][column];
          out[column] = sum;
        }
      }
    }
    return result;
  }

  void add_hessians(const Eigen::VectorXd& x, const Eigen::VectorXd& g, const Eigen::VectorXd& a,
                    const Eigen::VectorXd& b, SymmetricMatrix& matrix) const override {
    for (int first = 0; first < size(); first += kLane) {
      const Gradients gradients = load_gradients(first, g);
      Hessian block = Measure::template hessian<T>(load(Side::deformed, first, x), constants(first),
                                                   load_values(first, b));
      add_outer(gradients, gradients, first, a, block);
      add_block(first, block, matrix);
    }
  }

  void hessian_products(const Eigen::VectorXd& x, const Eigen::VectorXd& l,
                        Eigen::VectorXd& Hl) const override {
    Hl.resize(blocks() * kGradient);
    for (int first = 0; first < size(); first += kLane) {
      const Stencil stencil = load(Side::deformed, first, x);
      store_gradients(products(stencil, constants(first), load_flat(first, l)), first, Hl);
    }
  }

  void add_block_a(const Eigen::VectorXd& x, const Eigen::VectorXd& g, const Eigen::VectorXd& a,
                   const Eigen::VectorXd& b, const Eigen::VectorXd& db, const Eigen::VectorXd& l,
                   SymmetricMatrix& matrix) const override {
    for (int first = 0; first < size(); first += kLane) {
      const Stencil stencil = load(Side::deformed, first, x);
      const Parameters parameters = constants(first);
      const Direction direction = load_flat(first, l);
      const Gradients gradients = load_gradients(first, g), rates = products(stencil, parameters, direction);
      Hessian block = Measure::template hessian<T>(stencil, parameters, load_values(first, db)) +
                      Measure::template third<T>(stencil, parameters, load_values(first, b), direction);
      add_outer(gradients, rates, first, a, block);
      add_outer(rates, gradients, first, a, block);
      add_block(first, block, matrix);
    }
  }

  void add_rest_hessians(const Eigen::VectorXd& X, const Eigen::VectorXd& w, const RowMatrixXd& L,
                         Eigen::MatrixXd& out) const override {
    RowMatrixXd local(kSize, L.cols());
    Eigen::Matrix<double, kSize, kSize> H;
    for (int first = 0; first < size(); first += kLane) {
      const Hessian block =
          Measure::template hessian<T>(load(Side::rest, first, X), constants(first), load_values(first, w));
      for (int k = 0; k < lanes(first); ++k) {
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

  Eigen::Index blocks() const { return (size() + kLane - 1) / kLane; }
  int lanes(int first) const { return std::min(kLane, size() - first); }
  const int* stencil_of(Side side, int i) const { return stencils_[side == Side::rest].data() + kPoints * i; }

  // Lanes beyond the last term repeat it; what they give is not used.
  int term(int first, int k) const { return std::min(first + k, size() - 1); }

  Stencil load(Side side, int first, const Eigen::VectorXd& x) const {
    Stencil stencil;
    for (int k = 0; k < kLane; ++k) {
      const int* points = stencil_of(side, term(first, k));
      for (int n = 0; n < kPoints; ++n) {
        const double* point = x.data() + kDim * points[n];
        for (int axis = 0; axis < kDim; ++axis) set_lane(stencil(axis, n), k, point[axis]);
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

  Parameters constants(int first) const {
    Parameters parameters;
    for (int k = 0; k < kLane; ++k) {
      for (int n = 0; n < kParameters; ++n)
        set_lane(parameters[n], k, constants_[static_cast<std::size_t>(kParameters * term(first, k) + n)]);
    }
    return parameters;
  }

  Values load_values(int first, const Eigen::VectorXd& s) const {
    Values values;
    for (int k = 0; k < kLane; ++k) {
      for (int c = 0; c < kComponents; ++c) set_lane(values[c], k, s[kComponents * term(first, k) + c]);
    }
    return values;
  }
  void store_values(const Values& values, int first, Eigen::VectorXd& s) const {
    for (int k = 0; k < lanes(first); ++k) {
      for (int c = 0; c < kComponents; ++c) s[kComponents * (first + k) + c] = lane(values[c], k);
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
  double gradient_entry(const Eigen::VectorXd& g, int i, int component, int row) const {
    return g[i / kLane * kGradient + (component * kSize + row) * kLane + i % kLane];
  }

  // `Packs` packs of columns of the weighted sum of rows.
  template <int Packs>
  static void combine(const std::array<const double*, kSize>& rows, const std::array<double, kSize>& weights,
                      Eigen::Index column, double* out) {
    std::array<T, Packs> sums;
    for (int n = 0; n < Packs; ++n) sums[n] = T(0.0);
    for (int r = 0; r < kSize; ++r) {
      for (int n = 0; n < Packs; ++n) {
        sums[n] += T(weights[r]) * load_anywhere(rows[r] + column + n * kLane);
      }
    }
    for (int n = 0; n < Packs; ++n) store_anywhere(sums[n], out + column + n * kLane);
  }

  static Gradients products(const Stencil& stencil, const Parameters& parameters, const Direction& l) {
    Gradients result;
    for (int c = 0; c < kComponents; ++c) {
      result.col(c) = Measure::template hessian<T>(stencil, parameters, Values::Unit(c)).lazyProduct(l);
    }
    return result;
  }

  // Lower triangle of block += Σ a_kl g_k h_lᵀ over the components of a term.
  void add_outer(const Gradients& g, const Gradients& h, int first, const Eigen::VectorXd& a,
                 Hessian& block) const {
    if (a.size() == value_count()) {
      const Values weights = load_values(first, a);
      for (int c = 0; c < kComponents; ++c) add_outer_column(g, h.col(c) * weights[c], c, block);
      return;
    }
    for (int c = 0; c < kComponents; ++c) {
      Direction scaled = Direction::Zero();
      for (int d = 0; d < kComponents; ++d) {
        T weight(0.0);
        for (int k = 0; k < kLane; ++k) {
          set_lane(weight, k, a[kComponents * (kComponents * term(first, k) + c) + d]);
        }
        scaled += h.col(d) * weight;
      }
      add_outer_column(g, scaled, c, block);
    }
  }
  static void add_outer_column(const Gradients& g, const Direction& h, int component, Hessian& block) {
    for (int column = 0; column < kSize; ++column) {
      for (int row = column; row < kSize; ++row) block(row, column) += g(row, component) * h[column];
    }
  }

  // Adds the lower triangle of the block of every lane to the matrix, one column of a vertex block at a time.
  void add_block(int first, const Hessian& block, SymmetricMatrix& matrix) const {
    static constexpr int kPairs = kPoints * (kPoints + 1) / 2;
    double* values = matrix.values();
    const int count = lanes(first);
    std::array<const int*, kLane> column_of;
    for (int k = 0; k < count; ++k) column_of[k] = columns_.data() + kPairs * kDim * (first + k);
    int pair = 0;
    for (int a = 0; a < kPoints; ++a) {
      for (int b = 0; b <= a; ++b, ++pair) {
        if (a == b) {
          for (int j = 0; j < kDim; ++j) {
            for (int i = j; i < kDim; ++i) {
              for (int k = 0; k < count; ++k) {
                values[column_of[k][kDim * pair + j] + i - j] += lane(block(kDim * a + i, kDim * a + j), k);
              }
            }
          }
          continue;
        }
        T turned(0.0);
        for (int k = 0; k < kLane; ++k) {
          set_lane(turned, k, turned_[static_cast<std::size_t>(kPairs * term(first, k) + pair)]);
        }
        for (int j = 0; j < kDim; ++j) {
          for (int i = 0; i < kDim; ++i) {
            const T entry =
                select(turned, block(kDim * a + j, kDim * b + i), block(kDim * a + i, kDim * b + j));
            for (int k = 0; k < count; ++k) values[column_of[k][kDim * pair + j] + i] += lane(entry, k);
          }
        }
      }
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

  static T load_anywhere(const double* from) {
    if constexpr (kLane == 1) {
      return *from;
    } else {
      return T(from, std::experimental::element_aligned);
    }
  }
  static void store_anywhere(const T& value, double* to) {
    if constexpr (kLane == 1) {
      *to = value;
    } else {
      value.copy_to(to, std::experimental::element_aligned);
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
