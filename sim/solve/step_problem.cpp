#include "sim/solve/step_problem.h"

#include <algorithm>

namespace vivify::sim {

StepProblem::StepProblem(const BodyModel& body, const ContactSet& contacts, const Goals& goals,
                         Eigen::VectorXd x_tilde, Eigen::VectorXd q_n, double h)
    : body_(body), contacts_(contacts), goals_(goals), x_tilde_(std::move(x_tilde)), q_n_(std::move(q_n)) {
  inertia_.resize(x_tilde_.size());
  for (Eigen::Index i = 0; i < body.mass.size(); ++i)
    inertia_.segment<3>(3 * i).setConstant(body.mass[i] / (h * h));
}

RestPoint StepProblem::rest_point(const Eigen::VectorXd& q, bool with_derivatives) const {
  RestPoint rest;
  rest.q = q;
  const Eigen::VectorXd X = body_.rest.shape(q);
  const std::size_t families = body_.elastic.size();
  rest.S.resize(families);
  if (with_derivatives) rest.J.resize(families);
  rest.regularizer = 0.5 * body_.rate_weight * (q - q_n_).squaredNorm();
  for (std::size_t f = 0; f < families; ++f) {
    if (with_derivatives) {
      Eigen::MatrixXd G;
      body_.elastic[f]->gradients(Side::rest, X, rest.S[f], G);
      rest.J[f] = body_.elastic[f]->gather(Side::rest, G, body_.rest.Lq);
    } else {
      body_.elastic[f]->values(Side::rest, X, rest.S[f]);
    }
    rest.regularizer +=
        0.5 * (body_.regularizer_coefficients[f].array() * (rest.S[f] - body_.S0[f]).array().square()).sum();
  }
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

double StepProblem::objective(const Eigen::VectorXd& x, const RestPoint& rest) const {
  return 0.5 * goals_.residual(x).squaredNorm() + rest.regularizer;
}

double StepProblem::elastic_energy(const DeformedPoint& at, const RestPoint& rest) const {
  double sum = 0;
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    sum += 0.5 * (body_.elastic[f]->coefficients().array() * (at.s[f] - rest.S[f]).array().square()).sum();
  }
  return sum;
}

double StepProblem::potential(const DeformedPoint& at, const RestPoint& rest) const {
  return 0.5 * (inertia_.array() * (at.x - x_tilde_).array().square()).sum() + elastic_energy(at, rest) +
         contacts_.energy(at.x);
}

Eigen::VectorXd StepProblem::elastic_gradient(const DeformedPoint& at, const RestPoint& rest) const {
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(at.x.size());
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    const Eigen::VectorXd stress = body_.elastic[f]->coefficients().cwiseProduct(at.s[f] - rest.S[f]);
    body_.elastic[f]->scatter(Side::deformed, at.g[f], stress, gradient);
  }
  return gradient;
}

Eigen::VectorXd StepProblem::residual(const DeformedPoint& at, const RestPoint& rest) const {
  Eigen::VectorXd c = elastic_gradient(at, rest);
  c += inertia_.cwiseProduct(at.x - x_tilde_);
  contacts_.add_gradient(at.x, c);
  return c;
}

void StepProblem::stiffness(const DeformedPoint& at, const RestPoint& rest, SymmetricMatrix& D) const {
  D.set_zero();
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    const MeasureFamily& family = *body_.elastic[f];
    family.add_hessians(at.x, at.g[f], family.coefficients(),
                        family.coefficients().cwiseProduct(at.s[f] - rest.S[f]), D);
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
  double smallest = 1;
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    if (body_.elastic[f]->measures_size()) {
      smallest = std::min(smallest, measures[f].cwiseQuotient(body_.S0[f]).minCoeff());
    }
  }
  return smallest;
}

double StepProblem::smallest_element(const DeformedPoint& at) const { return smallest_ratio(at.s); }

// E = −Σ c g Gᵀ L: with rows g_iᵀ stacked in Γ and J = ∂S/∂q, E = −Γᵀ diag(c) J.
Eigen::MatrixXd StepProblem::multiply_E(const DeformedPoint& at, const RestPoint& rest,
                                        const Eigen::MatrixXd& dq) const {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(at.x.size(), dq.cols());
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    const Eigen::MatrixXd dS = rest.J[f] * dq;
    for (Eigen::Index k = 0; k < dq.cols(); ++k) {
      Eigen::VectorXd column = result.col(k);
      body_.elastic[f]->scatter(Side::deformed, at.g[f],
                                -body_.elastic[f]->coefficients().cwiseProduct(dS.col(k)), column);
      result.col(k) = column;
    }
  }
  return result;
}

Eigen::MatrixXd StepProblem::multiply_Et(const DeformedPoint& at, const RestPoint& rest,
                                         const Eigen::MatrixXd& Y) const {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(q_n_.size(), Y.cols());
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    const Eigen::MatrixXd gY = body_.elastic[f]->gather(Side::deformed, at.g[f], Y);
    result.noalias() -= rest.J[f].transpose() * (body_.elastic[f]->coefficients().asDiagonal() * gY);
  }
  return result;
}

Eigen::VectorXd StepProblem::regularizer_gradient(const RestPoint& rest) const {
  Eigen::VectorXd gradient = body_.rate_weight * (rest.q - q_n_);
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    gradient +=
        rest.J[f].transpose() * body_.regularizer_coefficients[f].cwiseProduct(rest.S[f] - body_.S0[f]);
  }
  return gradient;
}

Eigen::MatrixXd StepProblem::regularizer_gauss_newton(const RestPoint& rest) const {
  Eigen::MatrixXd R = body_.rate_weight * Eigen::MatrixXd::Identity(q_n_.size(), q_n_.size());
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    const Eigen::MatrixXd scaled = body_.regularizer_coefficients[f].cwiseSqrt().asDiagonal() * rest.J[f];
    R.selfadjointView<Eigen::Lower>().rankUpdate(scaled.transpose());
  }
  R.triangularView<Eigen::StrictlyUpper>() = R.transpose();
  return R;
}

void StepProblem::block_A(const DeformedPoint& at, const RestPoint& rest, const Eigen::VectorXd& lambda,
                          SymmetricMatrix& A) const {
  A.set_zero();
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    body_.elastic[f]->add_block_a(at.x, rest.S[f], lambda, A);
  }
  contacts_.add_block_a(at.x, lambda, body_.contact_slots, A);
}

Eigen::MatrixXd StepProblem::block_B(const DeformedPoint& at, const RestPoint& rest,
                                     const Eigen::VectorXd& lambda) const {
  // Row q of −Σ c (∂S/∂q)ᵀ (Hl)ᵀ.
  Eigen::MatrixXd B = Eigen::MatrixXd::Zero(q_n_.size(), at.x.size());
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    const MeasureFamily& family = *body_.elastic[f];
    const Eigen::MatrixXd Hl = family.hessian_products(at.x, lambda);
    for (Eigen::Index k = 0; k < B.rows(); ++k) {
      Eigen::VectorXd row = B.row(k).transpose();
      family.scatter(Side::deformed, Hl, -family.coefficients().cwiseProduct(rest.J[f].col(k)), row);
      B.row(k) = row.transpose();
    }
  }
  return B;
}

Eigen::MatrixXd StepProblem::block_C(const DeformedPoint& at, const RestPoint& rest,
                                     const Eigen::VectorXd& lambda) const {
  Eigen::MatrixXd C = regularizer_gauss_newton(rest);
  const Eigen::VectorXd X = body_.rest.shape(rest.q);
  for (std::size_t f = 0; f < body_.elastic.size(); ++f) {
    const MeasureFamily& family = *body_.elastic[f];
    const Eigen::VectorXd gl = family.gather(Side::deformed, at.g[f], lambda);
    const Eigen::VectorXd weights = body_.regularizer_coefficients[f].cwiseProduct(rest.S[f] - body_.S0[f]) -
                                    family.coefficients().cwiseProduct(gl);
    family.add_rest_hessians(X, weights, body_.rest.Lq, C);
  }
  return C;
}

}  // namespace vivify::sim
