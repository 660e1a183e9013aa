// The elastic law of a family of terms: energy w(s, S) of the measures s of the deformed and S of the rest
// stencil, with the derivatives that the step needs. A term has m components; `c` has one coefficient per
// term, s, S and ds one value per component, term by term; tables have one row per value.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "common/matrix.h"

namespace vivify::sim {

struct MeasureValues {
  const Eigen::VectorXd& c;
  const Eigen::VectorXd& s;
  const Eigen::VectorXd& S;
};

class Law {
 public:
  virtual ~Law() = default;

  virtual double energy(const MeasureValues& at) const = 0;
  // ∂w/∂s.
  virtual Eigen::VectorXd stress(const MeasureValues& at) const = 0;
  // ∂²w/∂s²: one value per component when diagonal(), else m · m per term.
  virtual bool diagonal() const = 0;
  virtual Eigen::VectorXd stiffness(const MeasureValues& at) const = 0;
  // (∂²w/∂s∂S) rows and its transpose, (∂²w/∂S∂s) rows.
  virtual RowMatrixXd couple(const MeasureValues& at, const RowMatrixXd& rows) const = 0;
  virtual RowMatrixXd couple_transposed(const MeasureValues& at, const RowMatrixXd& rows) const = 0;

  // Third derivatives along a change ds of s; all vanish for a quadratic law.
  virtual bool quadratic() const = 0;
  // (∂³w/∂s²∂S · ds) rows and (∂³w/∂s∂S² · ds) rows.
  virtual RowMatrixXd couple_rate(const MeasureValues& at, const Eigen::VectorXd& ds,
                                  const RowMatrixXd& rows) const = 0;
  virtual RowMatrixXd rest_curvature(const MeasureValues& at, const Eigen::VectorXd& ds,
                                     const RowMatrixXd& rows) const = 0;
};

// w = ½ c Σ (s − S)²; for an angle (`periodic`) the difference is taken modulo 2π.
std::unique_ptr<Law> make_quadratic_law(int components, bool periodic);

// The 2-D solid exactly as printed in Appendix A of Coros et al. 2012: w = ½ c ‖E‖² with E = ½ (FᵀF − 1) and
// F = S(x) S(X)⁻¹. With the metrics P = 1 + 2 E(s) and Q = 1 + 2 E(S) in the reference frame (s, S: the three
// components of sim/elastic/measures/green_strain.h), ‖E‖² = ¼ (tr (Q⁻¹P)² − 2 tr Q⁻¹P + 2), quadratic in s
// and rational in S.
std::unique_ptr<Law> make_printed_green_law();

// Coefficients of the terms, one per value: each is repeated for the components of its term.
Eigen::VectorXd per_value(const Eigen::VectorXd& c, int components);

// s − S as the laws see it.
Eigen::VectorXd strain(const Eigen::VectorXd& s, const Eigen::VectorXd& S, bool periodic);

}  // namespace vivify::sim
