#include "sim/solve/step_problem.h"

#include <algorithm>
#include <cmath>

#include "sim/solve/dense_product.h"

namespace vivify::sim {
namespace {

bool is_periodic(const MeasureFamily& family) { return family.kind() == MeasureKind::angle; }

}  // namespace

StepProblem::StepProblem(const BodyModel& body, const ContactSet& contacts, const Goals& goals,
                         const Eigen::VectorXd& x_n, Eigen::VectorXd x_tilde, Eigen::VectorXd q_n, double h)
    : body_(body),
      contacts_(contacts),
      goals_(goals),
      x_tilde_(std::move(x_tilde)),
      q_n_(std::move(q_n)),
      damping_(body.damping / h) {
  const int d = body.dimension();
  inertia_.resize(x_tilde_.size());
  for (Eigen::Index i = 0; i < body.mass.size(); ++i)
    inertia_.segment(d * i, d).setConstant(body.mass[i] / (h * h));
  if (damping_ == 0) return;
  s_n_.resize(body.elastic.size());
  for (std::size_t f = 0; f < body.elastic.size(); ++f) body.elastic[f]->values(Side::deformed, x_n, s_n_[f]);
}

RestPoint StepProblem::rest_point(const Eigen::VectorXd& q, bool with_derivatives) const {
  RestPoint rest;
  rest.q = q;
  body_.rest->measures(body_.elastic, q, rest.S, with_derivatives ? &rest.J : nullptr);
  rest.regularizer = 0.5 * body_.rate_weight * (q - q_n_).squaredNorm();
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    const Eigen::VectorXd change = strain(rest.S[f], body_.S0[f], is_periodic(*body_.elastic[f]));
    rest.regularizer += 0.5 * body_.regularizer_coefficients[f].dot(change.cwiseAbs2());
  }
  rest.regularizer += body_.hull.energy(body_.rest->basis() * q);
  rest.smallest_element = smallest_ratio(rest.S);
  return rest;
}

DeformedPoint StepProblem::deformed_point(const Eigen::VectorXd& x) const {
  DeformedPoint at;
  at.x = x;
  at.s.resize(body_.elastic.size());
  at.g.resize(body_.elastic.size());
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    body_.elastic[f]->gradients(Side::deformed, x, at.s[f], at.g[f]);
  }
  return at;
}

MeasureValues StepProblem::values(std::size_t f, const DeformedPoint& at, const RestPoint& rest) const {
  return {body_.elastic[f]->coefficients(), at.s[f], rest.S[f]};
}

Eigen::VectorXd StepProblem::stress(std::size_t f, const DeformedPoint& at, const RestPoint& rest) const {
  const MeasureFamily& family = *body_.elastic[f];
  Eigen::VectorXd stress = family.law().stress(values(f, at, rest));
  if (damping_ > 0) {
    stress += damping_ * per_value(family.coefficients(), family.components())
                             .cwiseProduct(strain(at.s[f], s_n_[f], is_periodic(family)));
  }
  return stress;
}

Eigen::VectorXd StepProblem::stress_slope(std::size_t f, const DeformedPoint& at,
                                          const RestPoint& rest) const {
  const MeasureFamily& family = *body_.elastic[f];
  Eigen::VectorXd slope = family.law().stiffness(values(f, at, rest));
  if (damping_ == 0) return slope;
  const Eigen::VectorXd c = per_value(family.coefficients(), family.components());
  if (family.law().diagonal()) return slope + damping_ * c;
  const int m = family.components();
  for (int i = 0; i < family.value_count(); ++i) {
    slope[m * i + i % m] += damping_ * c[i];  // row i % m of the m by m block of its term
  }
  return slope;
}

double StepProblem::objective(const Eigen::VectorXd& x, const RestPoint& rest) const {
  return 0.5 * goals_.residual(x).squaredNorm() + rest.regularizer;
}

double StepProblem::elastic_energy(const DeformedPoint& at, const RestPoint& rest) const {
  double sum = 0;
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    sum += body_.elastic[f]->law().energy(values(f, at, rest));
  }
  return sum;
}

double StepProblem::potential(const DeformedPoint& at, const RestPoint& rest) const {
  double sum = 0.5 * (inertia_.array() * (at.x - x_tilde_).array().square()).sum() +
               elastic_energy(at, rest) + contacts_.energy(at.x);
  if (damping_ == 0) return sum;
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    const MeasureFamily& family = *body_.elastic[f];
    sum += 0.5 * damping_ *
           per_value(family.coefficients(), family.components())
               .dot(strain(at.s[f], s_n_[f], is_periodic(family)).cwiseAbs2());
  }
  return sum;
}

Eigen::VectorXd StepProblem::internal_gradient(const DeformedPoint& at, const RestPoint& rest) const {
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(at.x.size());
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    body_.elastic[f]->scatter(Side::deformed, at.g[f], stress(f, at, rest), gradient);
  }
  return gradient;
}

Eigen::VectorXd StepProblem::residual(const DeformedPoint& at, const RestPoint& rest) const {
  Eigen::VectorXd c = internal_gradient(at, rest);
  c += inertia_.cwiseProduct(at.x - x_tilde_);
  contacts_.add_gradient(at.x, c);
  return c;
}

void StepProblem::stiffness(const DeformedPoint& at, const RestPoint& rest, SymmetricMatrix& D) const {
  D.set_zero();
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    body_.elastic[f]->add_hessians(at.x, at.g[f], stress_slope(f, at, rest), stress(f, at, rest), D);
  }
  contacts_.add_hessian(at.x, body_.contact_slots, D);
  add_inertia(1, D);
}

void StepProblem::add_inertia(double scale, SymmetricMatrix& D) const {
  for (Eigen::Index i = 0; i < inertia_.size(); ++i) {
    D.values()[body_.diagonal_slots[static_cast<std::size_t>(i)]] += scale * inertia_[i];
  }
}

double StepProblem::smallest_ratio(const std::vector<Eigen::VectorXd>& measures) const {
  double smallest = INFINITY, shortest = INFINITY;
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    const MeasureFamily& family = *body_.elastic[f];
    if (family.size() == 0) continue;
    if (family.kind() == MeasureKind::size) {
      smallest = std::min(smallest, measures[f].cwiseQuotient(body_.S0[f]).minCoeff());
    } else if (family.points_per_term() == 2) {
      shortest = std::min(shortest, std::sqrt(measures[f].cwiseQuotient(body_.S0[f]).minCoeff()));
    }
  }
  return std::min(1.0, std::isinf(smallest) ? shortest : smallest);
}

double StepProblem::smallest_element(const DeformedPoint& at) const { return smallest_ratio(at.s); }

// With the rows g_iᵀ stacked in Γ and J = ∂S/∂q, E = Γᵀ (∂²w/∂s∂S) J.
Eigen::MatrixXd StepProblem::multiply_E(const DeformedPoint& at, const RestPoint& rest,
                                        const Eigen::MatrixXd& dq) const {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(at.x.size(), dq.cols());
  Eigen::VectorXd column(at.x.size());
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    const MeasureFamily& family = *body_.elastic[f];
    const RowMatrixXd stress_change = family.law().couple(values(f, at, rest), rest.J[f] * dq);
    for (Eigen::Index k = 0; k < dq.cols(); ++k) {
      column.setZero();
      family.scatter(Side::deformed, at.g[f], stress_change.col(k), column);
      result.col(k) += column;
    }
  }
  return result;
}

Eigen::MatrixXd StepProblem::multiply_Et(const DeformedPoint& at, const RestPoint& rest,
                                         const RowMatrixXd& Y) const {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(q_n_.size(), Y.cols());
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    const MeasureFamily& family = *body_.elastic[f];
    const RowMatrixXd gY = family.gather(Side::deformed, at.g[f], Y);
    result += transposed_product(rest.J[f], family.law().couple_transposed(values(f, at, rest), gY));
  }
  return result;
}

Eigen::VectorXd StepProblem::regularizer_gradient(const RestPoint& rest) const {
  Eigen::VectorXd gradient = body_.rate_weight * (rest.q - q_n_);
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    const Eigen::VectorXd change = strain(rest.S[f], body_.S0[f], is_periodic(*body_.elastic[f]));
    gradient.noalias() += rest.J[f].transpose() * body_.regularizer_coefficients[f].cwiseProduct(change);
  }
  if (body_.hull.groups.empty()) return gradient;
  const Eigen::MatrixXd& basis = body_.rest->basis();
  Eigen::VectorXd of_p = Eigen::VectorXd::Zero(basis.rows());
  body_.hull.add_gradient(basis * rest.q, of_p);
  return gradient + basis.transpose() * of_p;
}

Eigen::MatrixXd StepProblem::regularizer_gauss_newton(const RestPoint& rest) const {
  Eigen::MatrixXd R = body_.rate_weight * Eigen::MatrixXd::Identity(q_n_.size(), q_n_.size());
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    R += weighted_square(rest.J[f], body_.regularizer_coefficients[f]);
  }
  if (body_.hull.groups.empty()) return R;
  const Eigen::MatrixXd& basis = body_.rest->basis();
  Eigen::MatrixXd of_p = Eigen::MatrixXd::Zero(basis.rows(), basis.rows());
  body_.hull.add_hessian(basis * rest.q, of_p);
  return R + basis.transpose() * of_p * basis;
}

void StepProblem::block_A(const DeformedPoint& at, const RestPoint& rest, const Eigen::VectorXd& lambda,
                          SymmetricMatrix& A) const {
  A.set_zero();
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    const MeasureFamily& family = *body_.elastic[f];
    const Eigen::VectorXd slope = stress_slope(f, at, rest);
    const Eigen::VectorXd ds = family.gather(Side::deformed, at.g[f], lambda);
    Eigen::VectorXd dstress;
    if (family.law().diagonal()) {
      dstress = slope.cwiseProduct(ds);
    } else {
      const int m = family.components();
      dstress.resize(ds.size());
      for (int i = 0; i < family.value_count(); ++i) {
        dstress[i] = slope.segment(m * i, m).dot(ds.segment(i / m * m, m));
      }
    }
    family.add_block_a(at.x, at.g[f], slope, stress(f, at, rest), dstress, lambda, A);
  }
  contacts_.add_block_a(at.x, lambda, body_.contact_slots, A);
}

Eigen::MatrixXd StepProblem::block_B(const DeformedPoint& at, const RestPoint& rest,
                                     const Eigen::VectorXd& lambda) const {
  Eigen::MatrixXd B = Eigen::MatrixXd::Zero(q_n_.size(), at.x.size());
  Eigen::VectorXd row(at.x.size()), Hl;
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    const MeasureFamily& family = *body_.elastic[f];
    const MeasureValues where = values(f, at, rest);
    family.hessian_products(at.x, lambda, Hl);
    const RowMatrixXd coupled = family.law().couple(where, rest.J[f]);
    RowMatrixXd rate;
    if (!family.law().quadratic()) {
      const Eigen::VectorXd ds = family.gather(Side::deformed, at.g[f], lambda);
      rate = family.law().couple_rate(where, ds, rest.J[f]);
    }
    for (Eigen::Index k = 0; k < B.rows(); ++k) {
      row.setZero();
      family.scatter(Side::deformed, Hl, coupled.col(k), row);
      if (rate.size() > 0) family.scatter(Side::deformed, at.g[f], rate.col(k), row);
      B.row(k) += row.transpose();
    }
  }
  return B;
}

Eigen::MatrixXd StepProblem::block_C(const DeformedPoint& at, const RestPoint& rest,
                                     const Eigen::VectorXd& lambda) const {
  Eigen::MatrixXd C = regularizer_gauss_newton(rest);
  std::vector<Eigen::VectorXd> weights(body_.elastic.size());
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    const MeasureFamily& family = *body_.elastic[f];
    const MeasureValues where = values(f, at, rest);
    const RowMatrixXd ds = family.gather(Side::deformed, at.g[f], lambda);
    const Eigen::VectorXd change = strain(rest.S[f], body_.S0[f], is_periodic(family));
    weights[f] = body_.regularizer_coefficients[f].cwiseProduct(change) +
                 Eigen::VectorXd(family.law().couple_transposed(where, ds));
    if (!family.law().quadratic()) {
      C.noalias() += rest.J[f].transpose() * family.law().rest_curvature(where, ds.col(0), rest.J[f]);
    }
  }
  body_.rest->add_hessians(body_.elastic, rest.q, weights, C);
  return C;
}

}  // namespace vivify::sim
