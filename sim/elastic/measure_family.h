// The one form of every elastic energy: W = Σ ½ c (s(x) − S(X))², with the same measure s taken on the
// deformed and on the rest stencil. A family is all terms of a model that share one measure. Closed forms of
// the derivatives, with g = ∇s(x), H = ∇²s(x), G = ∇S(X) and l the part of λ on the element:
//   ∂W/∂x = c (s − S) g                       (minus the internal force)
//   D     = c (g gᵀ + (s − S) H)              ∂²W/∂x²
//   E     = −c g Gᵀ                           ∂²W/∂x∂X
//   A     = c ((g·l) H + g (Hl)ᵀ + (Hl) gᵀ + (s − S) ∇³s[l]),   B = −c G (Hl)ᵀ,   C = −c (g·l) ∇²S
// A, B, C are the elastic parts of the blocks of equation (13) of Coros et al. 2012.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "sim/solve/sparse_matrix.h"

namespace vivify::sim {

// Deformed stencils index the vertices of x; rest stencils index the points of the stacked rest shape X.
enum class Side { deformed, rest };

class MeasureFamily {
 public:
  virtual ~MeasureFamily() = default;

  virtual std::string name() const = 0;
  virtual int points_per_term() const = 0;
  // Whether s is the signed size of an element (area, volume): its ratio to the reference tells collapse and
  // inversion.
  virtual bool measures_size() const = 0;
  int size() const { return static_cast<int>(coefficients_.size()); }
  const Eigen::VectorXd& coefficients() const { return coefficients_; }  // #terms
  const std::vector<int>& stencils(Side side) const {
    return stencils_[side == Side::rest];
  }  // #terms · points

  // Adds a term. `deformed` and `rest` hold points_per_term() indices.
  void add(const std::vector<int>& deformed, const std::vector<int>& rest, double coefficient);

  // Joins terms that share both stencils into one with the sum of their coefficients (exact: same s, same S).
  void merge_equal_terms();

  // s of every term (#terms). `x` is the flat vector of positions (3 #points).
  virtual void values(Side side, const Eigen::VectorXd& x, Eigen::VectorXd& s) const = 0;

  // s, and ∇s as one column per term (3 points by #terms).
  virtual void gradients(Side side, const Eigen::VectorXd& x, Eigen::VectorXd& s,
                         Eigen::MatrixXd& g) const = 0;

  // out += Σ w_i g_i, scattered to the points.
  void scatter(Side side, const Eigen::MatrixXd& g, const Eigen::VectorXd& w, Eigen::VectorXd& out) const;

  // Row i is g_iᵀ Y restricted to the stencil of term i. Y is 3 #points by k; the result is #terms by k.
  Eigen::MatrixXd gather(Side side, const Eigen::MatrixXd& g, const Eigen::MatrixXd& Y) const;

  // matrix += Σ a_i g_i g_iᵀ + b_i ∇²s_i over deformed stencils.
  virtual void add_hessians(const Eigen::VectorXd& x, const Eigen::MatrixXd& g, const Eigen::VectorXd& a,
                            const Eigen::VectorXd& b, SymmetricMatrix& matrix) const = 0;

  // Column i is ∇²s_i l on the stencil of term i (3 points by #terms); l is flat (3 #points).
  virtual Eigen::MatrixXd hessian_products(const Eigen::VectorXd& x, const Eigen::VectorXd& l) const = 0;

  // matrix += the elastic part of block A for the multiplier l.
  virtual void add_block_a(const Eigen::VectorXd& x, const Eigen::VectorXd& S, const Eigen::VectorXd& l,
                           SymmetricMatrix& matrix) const = 0;

  // out += Σ w_i Lᵀ ∇²S_i L over rest stencils; X is the flat rest shape, L is 3 #rest points by #p.
  virtual void add_rest_hessians(const Eigen::VectorXd& X, const Eigen::VectorXd& w, const Eigen::MatrixXd& L,
                                 Eigen::MatrixXd& out) const = 0;

  // Declares the entries that add_hessians writes, and remembers where they lie.
  void reserve(SymmetricPattern& pattern) const;
  void bind(const SymmetricPattern& pattern);

 protected:
  Eigen::VectorXd coefficients_;
  std::vector<int> stencils_[2];
  std::vector<int> slots_;  // for each term, the places of the lower triangle of its block
};

std::unique_ptr<MeasureFamily> make_edge_length_family();
std::unique_ptr<MeasureFamily> make_volume_family();

}  // namespace vivify::sim
