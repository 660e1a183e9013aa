// The one form of every elastic energy: W = Σ w(s(x), S(X)), with the same measure s taken on the deformed
// and on the rest stencil. A family is all terms of a model that share one measure and one law; for nearly
// all of them w = ½ c (s − S)² (sim/elastic/law.h). Closed forms of the derivatives, for terms with one
// component, with g = ∇s(x), H = ∇²s(x), G = ∇S(X) and l the part of λ on the stencil:
//   ∂W/∂x = w_s g                             (minus the internal force)
//   D     = w_ss g gᵀ + w_s H                 ∂²W/∂x²
//   E     = w_sS g Gᵀ                         ∂²W/∂x∂X
//   A     = w_ss ((g·l) H + g (Hl)ᵀ + (Hl) gᵀ) + w_s ∇³s[l]
//   B     = w_sS G (Hl)ᵀ + …,   C = w_Ss (g·l) ∇²S + …
// A, B, C are the elastic parts of the blocks of equation (13) of Coros et al. 2012.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/matrix.h"
#include "sim/elastic/law.h"
#include "sim/solve/sparse_matrix.h"

namespace vivify::sim {

// Deformed stencils index the vertices of x; rest stencils index the points of the stacked rest shape X.
enum class Side { deformed, rest };

// What happens to a measure when a body is squeezed: which stiffness of the regulariser scales it, and
// whether it tells collapse.
enum class MeasureKind { stretch, size, angle };

class MeasureFamily {
 public:
  explicit MeasureFamily(std::unique_ptr<Law> law) : law_(std::move(law)) {}
  virtual ~MeasureFamily() = default;

  virtual std::string_view name() const = 0;
  virtual MeasureKind kind() const = 0;
  virtual int dimension() const = 0;  // coordinates per point
  virtual int points_per_term() const = 0;
  virtual int components() const = 0;  // values per term
  virtual int parameters() const = 0;  // constants per term, from the reference shape
  int size() const { return static_cast<int>(coefficients_.size()); }  // #terms
  int value_count() const { return size() * components(); }
  // Terms in a row that share their deformed stencil (and differ at rest) are measured once on that side.
  int stencil_count(Side side) const {
    return side == Side::rest ? size() : static_cast<int>(runs_.size()) - 1;
  }
  const Eigen::VectorXd& coefficients() const { return coefficients_; }  // #terms
  const std::vector<int>& stencils(Side side) const {
    return stencils_[side == Side::rest];
  }  // #terms · points
  const Law& law() const { return *law_; }

  // Adds a term. `deformed` and `rest` hold points_per_term() indices, `constants` parameters() numbers.
  void add(std::span<const int> deformed, std::span<const int> rest, double coefficient,
           std::span<const double> constants = {});

  // Joins terms that share both stencils into one with the sum of their coefficients (exact: same s, same S).
  // For measures without constants.
  void merge_equal_terms();

  // s of every term (#values), component by component of each term. `x` is the flat vector of positions.
  virtual void values(Side side, const Eigen::VectorXd& x, Eigen::VectorXd& s) const = 0;

  // s, and ∇s in the layout that the other functions take: per stencil.
  virtual void gradients(Side side, const Eigen::VectorXd& x, Eigen::VectorXd& s,
                         Eigen::VectorXd& g) const = 0;

  // out += Σ w_i g_i, scattered to the points.
  virtual void scatter(Side side, const Eigen::VectorXd& g, const Eigen::VectorXd& w,
                       Eigen::VectorXd& out) const = 0;

  // Row i is g_iᵀ Y restricted to the stencil of value i. Y has a row per coordinate of the points; the
  // result is #values by k.
  virtual RowMatrixXd gather(Side side, const Eigen::VectorXd& g, const RowMatrixXd& Y) const = 0;

  // matrix += Σ a g gᵀ + b ∇²s over deformed stencils. `a` has one number per value, or components² per term
  // that couple the components of a term; `b` one per value.
  virtual void add_hessians(const Eigen::VectorXd& x, const Eigen::VectorXd& g, const Eigen::VectorXd& a,
                            const Eigen::VectorXd& b, SymmetricMatrix& matrix) const = 0;

  // ∇²s l for every value, in the layout of the gradients; l is flat.
  virtual void hessian_products(const Eigen::VectorXd& x, const Eigen::VectorXd& l,
                                Eigen::VectorXd& Hl) const = 0;

  // matrix += the derivative of add_hessians(x, g, a, b) along l, for a law that is quadratic in s: with
  // db = ∂b/∂s · (g·l).
  virtual void add_block_a(const Eigen::VectorXd& x, const Eigen::VectorXd& g, const Eigen::VectorXd& a,
                           const Eigen::VectorXd& b, const Eigen::VectorXd& db, const Eigen::VectorXd& l,
                           SymmetricMatrix& matrix) const = 0;

  // out += Σ w_i Lᵀ ∇²S_i L over rest stencils; X is the flat rest shape, L has a row per coordinate of it.
  virtual void add_rest_hessians(const Eigen::VectorXd& X, const Eigen::VectorXd& w, const RowMatrixXd& L,
                                 Eigen::MatrixXd& out) const = 0;

  // Declares the entries that add_hessians writes, and remembers where they lie, in a pattern where the
  // body's vertices begin at `first_vertex`.
  void reserve(SymmetricPattern& pattern, int first_vertex = 0) const;
  void bind(const SymmetricPattern& pattern, int first_vertex = 0);

 protected:
  // The first of the terms of a stencil; they end where those of the next stencil begin.
  int first_term(Side side, int stencil) const {
    return side == Side::rest ? stencil : runs_[static_cast<std::size_t>(stencil)];
  }
  const int* stencil_of(Side side, int stencil) const {
    return (side == Side::rest ? stencils_[1] : measured_).data() + points_per_term() * stencil;
  }
  // Numbers per term, summed over the terms of each stencil; `sums` holds them where there is anything to
  // sum.
  const Eigen::VectorXd& sum_terms(Side side, const Eigen::VectorXd& numbers, Eigen::VectorXd& sums) const;
  // From values per stencil to values per term.
  void spread_to_terms(Side side, Eigen::VectorXd& values) const;

  Eigen::VectorXd coefficients_;
  std::vector<int> stencils_[2];
  std::vector<double> constants_;
  std::vector<int> measured_;    // deformed stencils that differ from the one before
  std::vector<int> runs_ = {0};  // term where the run of each of them begins, and the end
  std::vector<int> columns_;     // for each of them and pair of points, where the
                                 // block lies in the matrix
  std::vector<double> turned_;   // and whether it lies there transposed
  std::unique_ptr<Law> law_;
};

// How many terms the kernels take at a time: SIMD packets, or one by one (for comparison).
enum class Kernels { packets, scalar };

struct MeasureEntry {
  std::string_view name;
  int dimension;
  std::unique_ptr<MeasureFamily> (*make)(Kernels kernels);
};

// Every measure. A new one is a header in measures/ and a line in this table.
std::span<const MeasureEntry> measures();
std::unique_ptr<MeasureFamily> make_family(std::string_view measure, Kernels kernels = Kernels::packets);

}  // namespace vivify::sim
