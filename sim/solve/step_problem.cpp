#include "sim/solve/step_problem.h"

#include <algorithm>
#include <cmath>

#include "common/parallel.h"
#include "sim/solve/dense_product.h"

namespace vivify::sim {
namespace {

bool is_periodic(const MeasureFamily& family) { return family.kind() == MeasureKind::angle; }

}  // namespace

StepProblem::StepProblem(std::vector<BodyStep> bodies, const PairContacts* pairs, const Goals& goals,
                         double h)
    : bodies_(std::move(bodies)), pairs_(pairs), goals_(goals), x_at_{0}, q_at_{0}, terms_at_{0}, h_(h) {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const BodyModel& body = *bodies_[b].body;
    x_at_.push_back(x_at_.back() + bodies_[b].x_n.size());
    q_at_.push_back(q_at_.back() + (is_free(b) ? bodies_[b].q_n.size() : 0));
    for (std::size_t f = 0; f < body.elastic.size(); ++f) terms_.push_back({body.elastic[f].get(), b, f});
    terms_at_.push_back(terms_.size());
  }
  x_tilde_.resize(x_at_.back());
  inertia_.resize(x_at_.back());
  q_n_.resize(q_at_.back());
  fixed_S_.resize(terms_.size());
  s_n_.resize(terms_.size());
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const BodyStep& step = bodies_[b];
    const BodyModel& body = *step.body;
    const int d = body.dimension();
    x_tilde_.segment(x_at_[b], dofs(b)) = step.x_tilde;
    for (Eigen::Index i = 0; i < body.mass.size(); ++i)
      inertia_.segment(x_at_[b] + d * i, d).setConstant(body.mass[i] / (h * h));
    if (is_free(b)) {
      q_n_.segment(q_at_[b], parameters(b)) = step.q_n;
    } else {
      std::vector<Eigen::VectorXd> S;
      body.rest->measures(body.elastic, *step.q, S, nullptr);
      fixed_regularizer_ += 0.5 * body.rate_weight * (*step.q - step.q_n).squaredNorm() + regularizer(b, S) +
                            body.hull.energy(body.rest->basis() * *step.q);
      std::move(S.begin(), S.end(), fixed_S_.begin() + static_cast<std::ptrdiff_t>(terms_at_[b]));
    }
    if (body.damping == 0) continue;
    for (std::size_t f = terms_at_[b]; f < terms_at_[b + 1]; ++f)
      terms_[f].family->values(Side::deformed, step.x_n, s_n_[f]);
  }
}

StepProblem::StepProblem(const BodyModel& body, const ContactSet& contacts, const Goals& goals,
                         const Eigen::VectorXd& x_n, Eigen::VectorXd x_tilde, Eigen::VectorXd q_n, double h)
    : StepProblem({{&body, &contacts, x_n, std::move(x_tilde), std::move(q_n)}}, nullptr, goals, h) {}

Eigen::VectorXd StepProblem::q_of(std::size_t b, const Eigen::VectorXd& q) const {
  return is_free(b) ? Eigen::VectorXd(q.segment(q_at_[b], parameters(b))) : *bodies_[b].q;
}

const SolverSettings& StepProblem::solver() const {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (is_free(b)) return body(b).solver;
  }
  return body().solver;
}

double StepProblem::energy_unit() const {
  double unit = INFINITY;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (is_free(b)) unit = std::min(unit, body(b).weight * body(b).height);
  }
  return unit;
}

double StepProblem::relative_force(const Eigen::VectorXd& c) const {
  double largest = 0;
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    largest = std::max(largest, c.segment(x_at_[b], dofs(b)).lpNorm<Eigen::Infinity>() / body(b).weight);
  return largest;
}

double StepProblem::relative_length(const Eigen::VectorXd& dx) const {
  double largest = 0;
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    largest = std::max(largest, dx.segment(x_at_[b], dofs(b)).lpNorm<Eigen::Infinity>() / body(b).height);
  return largest;
}

double StepProblem::relative_change(const Eigen::VectorXd& dq) const {
  double largest = 0;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (parameters(b) == 0) continue;
    const RestSpace& space = *body(b).rest;
    const Eigen::VectorXd dp = space.basis() * dq.segment(q_at_[b], parameters(b));
    largest = std::max(largest, dp.lpNorm<Eigen::Infinity>() / space.unit());
  }
  return largest;
}

void StepProblem::each_body(const std::function<void(std::size_t)>& function) const {
  if (bodies_.size() == 1) {
    function(0);
  } else {
    parallel_for(bodies_.size(), function);
  }
}

double StepProblem::regularizer(std::size_t b, const std::vector<Eigen::VectorXd>& S) const {
  double sum = 0;
  for (std::size_t f = 0; f < S.size(); ++f) {
    const Eigen::VectorXd change = strain(S[f], body(b).S0[f], is_periodic(*body(b).elastic[f]));
    sum += 0.5 * body(b).regularizer_coefficients[f].dot(change.cwiseAbs2());
  }
  return sum;
}

RestPoint StepProblem::rest_point(const Eigen::VectorXd& q, bool with_derivatives) const {
  RestPoint rest;
  rest.q = q;
  rest.S = fixed_S_;
  if (with_derivatives) rest.J.resize(terms_.size());
  std::vector<double> energies(bodies_.size(), 0), ratios(bodies_.size(), 1);
  each_body([&](std::size_t b) {
    if (!is_free(b)) return;
    const BodyModel& model = body(b);
    const Eigen::VectorXd own = q_of(b, q);
    std::vector<Eigen::VectorXd> S;
    std::vector<RowMatrixXd> J;
    model.rest->measures(model.elastic, own, S, with_derivatives ? &J : nullptr);
    energies[b] = 0.5 * model.rate_weight * (own - bodies_[b].q_n).squaredNorm();
    energies[b] += regularizer(b, S);
    energies[b] += model.hull.energy(model.rest->basis() * own);
    const auto first = static_cast<std::ptrdiff_t>(terms_at_[b]);
    std::move(S.begin(), S.end(), rest.S.begin() + first);
    if (with_derivatives) std::move(J.begin(), J.end(), rest.J.begin() + first);
    ratios[b] = smallest_ratio(b, rest.S);
  });
  rest.regularizer = fixed_regularizer_;
  for (const double energy : energies) rest.regularizer += energy;
  for (const double ratio : ratios) rest.smallest_element = std::min(rest.smallest_element, ratio);
  return rest;
}

DeformedPoint StepProblem::deformed_point(const Eigen::VectorXd& x) const {
  DeformedPoint at;
  at.x = x;
  at.s.resize(terms_.size());
  at.g.resize(terms_.size());
  if (bodies_.size() > 1) at.parts.resize(bodies_.size());
  each_body([&](std::size_t b) {
    if (bodies_.size() > 1) at.parts[b] = x_of(b, x);
    for (std::size_t f = terms_at_[b]; f < terms_at_[b + 1]; ++f)
      terms_[f].family->gradients(Side::deformed, at.of(b), at.s[f], at.g[f]);
  });
  return at;
}

MeasureValues StepProblem::values(std::size_t f, const DeformedPoint& at, const RestPoint& rest) const {
  return {terms_[f].family->coefficients(), at.s[f], rest.S[f]};
}

Eigen::VectorXd StepProblem::stress(std::size_t f, const DeformedPoint& at, const RestPoint& rest) const {
  const MeasureFamily& family = *terms_[f].family;
  const double damping = body(terms_[f].body).damping / h_;
  Eigen::VectorXd stress = family.law().stress(values(f, at, rest));
  if (damping > 0) {
    stress += damping * per_value(family.coefficients(), family.components())
                            .cwiseProduct(strain(at.s[f], s_n_[f], is_periodic(family)));
  }
  return stress;
}

Eigen::VectorXd StepProblem::stress_slope(std::size_t f, const DeformedPoint& at,
                                          const RestPoint& rest) const {
  const MeasureFamily& family = *terms_[f].family;
  const double damping = body(terms_[f].body).damping / h_;
  Eigen::VectorXd slope = family.law().stiffness(values(f, at, rest));
  if (damping == 0) return slope;
  const Eigen::VectorXd c = per_value(family.coefficients(), family.components());
  if (family.law().diagonal()) return slope + damping * c;
  const int m = family.components();
  for (int i = 0; i < family.value_count(); ++i) {
    slope[m * i + i % m] += damping * c[i];  // row i % m of the m by m block of its term
  }
  return slope;
}

double StepProblem::objective(const Eigen::VectorXd& x, const RestPoint& rest) const {
  return 0.5 * goals_.residual(x).squaredNorm() + rest.regularizer;
}

double StepProblem::elastic_energy(std::size_t b, const DeformedPoint& at, const RestPoint& rest) const {
  double sum = 0;
  for (std::size_t f = terms_at_[b]; f < terms_at_[b + 1]; ++f)
    sum += terms_[f].family->law().energy(values(f, at, rest));
  return sum;
}

double StepProblem::potential(const DeformedPoint& at, const RestPoint& rest) const {
  std::vector<double> energies(bodies_.size());
  each_body([&](std::size_t b) {
    const auto segment = [&](const Eigen::VectorXd& v) { return v.segment(x_at_[b], dofs(b)).array(); };
    double sum = 0.5 * (segment(inertia_) * (segment(at.x) - segment(x_tilde_)).square()).sum() +
                 elastic_energy(b, at, rest) + bodies_[b].contacts->energy(at.of(b));
    if (bodies_[b].hold != nullptr) sum += bodies_[b].hold->energy(at.of(b));
    const double damping = body(b).damping / h_;
    for (std::size_t f = terms_at_[b]; f < terms_at_[b + 1] && damping > 0; ++f) {
      const MeasureFamily& family = *terms_[f].family;
      sum += 0.5 * damping *
             per_value(family.coefficients(), family.components())
                 .dot(strain(at.s[f], s_n_[f], is_periodic(family)).cwiseAbs2());
    }
    energies[b] = sum;
  });
  double sum = pairs_ != nullptr ? pairs_->energy(at.x) : 0.0;
  for (const double energy : energies) sum += energy;
  return sum;
}

Eigen::VectorXd StepProblem::internal_gradient(std::size_t b, const DeformedPoint& at,
                                               const RestPoint& rest) const {
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(dofs(b));
  for (std::size_t f = terms_at_[b]; f < terms_at_[b + 1]; ++f)
    terms_[f].family->scatter(Side::deformed, at.g[f], stress(f, at, rest), gradient);
  return gradient;
}

Eigen::Vector3d StepProblem::handle_force(std::size_t b, const DeformedPoint& at) const {
  if (bodies_[b].hold == nullptr) return Eigen::Vector3d::Zero();
  return bodies_[b].hold->total_force(at.of(b));
}

Eigen::VectorXd StepProblem::residual(const DeformedPoint& at, const RestPoint& rest) const {
  Eigen::VectorXd c(at.x.size());
  each_body([&](std::size_t b) {
    Eigen::VectorXd part = internal_gradient(b, at, rest);
    const auto segment = [&](const Eigen::VectorXd& v) { return v.segment(x_at_[b], dofs(b)); };
    part += segment(inertia_).cwiseProduct(at.of(b) - segment(x_tilde_));
    bodies_[b].contacts->add_gradient(at.of(b), part);
    if (bodies_[b].hold != nullptr) bodies_[b].hold->add_gradient(at.of(b), part);
    c.segment(x_at_[b], dofs(b)) = part;
  });
  if (pairs_ != nullptr) pairs_->add_gradient(at.x, c);
  return c;
}

void StepProblem::stiffness(const DeformedPoint& at, const RestPoint& rest, SymmetricMatrix& D) const {
  D.set_zero();
  each_body([&](std::size_t b) {
    for (std::size_t f = terms_at_[b]; f < terms_at_[b + 1]; ++f) {
      terms_[f].family->add_hessians(at.of(b), at.g[f], stress_slope(f, at, rest), stress(f, at, rest), D);
    }
    bodies_[b].contacts->add_hessian(at.of(b), body(b).contact_slots, D);
    if (bodies_[b].hold != nullptr) bodies_[b].hold->add_hessian(body(b).diagonal_slots, D);
  });
  if (pairs_ != nullptr) pairs_->add_hessian(at.x, D);
  add_inertia(1, D);
}

void StepProblem::add_inertia(double scale, SymmetricMatrix& D) const {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    for (Eigen::Index i = 0; i < dofs(b); ++i) {
      D.values()[body(b).diagonal_slots[static_cast<std::size_t>(i)]] += scale * inertia_[x_at_[b] + i];
    }
  }
}

double StepProblem::smallest_ratio(std::size_t b, const std::vector<Eigen::VectorXd>& measures) const {
  double smallest = INFINITY, shortest = INFINITY;
  for (std::size_t f = terms_at_[b]; f < terms_at_[b + 1]; ++f) {
    const MeasureFamily& family = *terms_[f].family;
    const Eigen::VectorXd& S0 = body(b).S0[terms_[f].index];
    if (family.size() == 0) continue;
    if (family.kind() == MeasureKind::size) {
      smallest = std::min(smallest, measures[f].cwiseQuotient(S0).minCoeff());
    } else if (family.points_per_term() == 2) {
      shortest = std::min(shortest, std::sqrt(measures[f].cwiseQuotient(S0).minCoeff()));
    }
  }
  return std::min(1.0, std::isinf(smallest) ? shortest : smallest);
}

double StepProblem::smallest_element(std::size_t b, const DeformedPoint& at) const {
  return smallest_ratio(b, at.s);
}

double StepProblem::smallest_rest_element(std::size_t b, const RestPoint& rest) const {
  return smallest_ratio(b, rest.S);
}

double StepProblem::rest_volume(std::size_t b, const RestPoint& rest) const {
  double by_size = NAN, by_length = NAN;
  for (std::size_t f = terms_at_[b]; f < terms_at_[b + 1]; ++f) {
    const MeasureFamily& family = *terms_[f].family;
    const Eigen::VectorXd& S0 = body(b).S0[terms_[f].index];
    if (family.kind() == MeasureKind::size) {
      by_size = rest.S[f].sum() / S0.sum();
    } else if (family.points_per_term() == 2) {
      const bool rod = body(b).dimension() == 2;
      by_length = rod ? rest.S[f].cwiseSqrt().sum() / S0.cwiseSqrt().sum() : rest.S[f].sum() / S0.sum();
    }
  }
  return std::isnan(by_size) ? by_length : by_size;
}

double StepProblem::smallest_element(const DeformedPoint& at) const {
  double smallest = 1;
  for (std::size_t b = 0; b < bodies_.size(); ++b) smallest = std::min(smallest, smallest_element(b, at));
  return smallest;
}

// With the rows g_iᵀ stacked in Γ and J = ∂S/∂q, E = Γᵀ (∂²w/∂s∂S) J.
Eigen::MatrixXd StepProblem::multiply_E(const DeformedPoint& at, const RestPoint& rest,
                                        const Eigen::MatrixXd& dq) const {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(at.x.size(), dq.cols());
  each_body([&](std::size_t b) {
    if (parameters(b) == 0) return;
    Eigen::VectorXd column(dofs(b));
    for (std::size_t f = terms_at_[b]; f < terms_at_[b + 1]; ++f) {
      const MeasureFamily& family = *terms_[f].family;
      const RowMatrixXd stress_change =
          family.law().couple(values(f, at, rest), rest.J[f] * dq.middleRows(q_at_[b], parameters(b)));
      for (Eigen::Index k = 0; k < dq.cols(); ++k) {
        column.setZero();
        family.scatter(Side::deformed, at.g[f], stress_change.col(k), column);
        result.col(k).segment(x_at_[b], dofs(b)) += column;
      }
    }
  });
  return result;
}

Eigen::MatrixXd StepProblem::multiply_Et(const DeformedPoint& at, const RestPoint& rest,
                                         const RowMatrixXd& Y) const {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(q_n_.size(), Y.cols());
  each_body([&](std::size_t b) {
    if (parameters(b) == 0) return;
    const auto multiply = [&](const RowMatrixXd& own) {
      for (std::size_t f = terms_at_[b]; f < terms_at_[b + 1]; ++f) {
        const MeasureFamily& family = *terms_[f].family;
        const RowMatrixXd gY = family.gather(Side::deformed, at.g[f], own);
        result.middleRows(q_at_[b], parameters(b)) +=
            transposed_product(rest.J[f], family.law().couple_transposed(values(f, at, rest), gY));
      }
    };
    if (bodies_.size() == 1) {
      multiply(Y);
    } else {
      multiply(Y.middleRows(x_at_[b], dofs(b)));
    }
  });
  return result;
}

Eigen::VectorXd StepProblem::regularizer_gradient(const RestPoint& rest) const {
  Eigen::VectorXd all(q_n_.size());
  each_body([&](std::size_t b) {
    if (parameters(b) == 0) return;
    const BodyModel& model = body(b);
    const Eigen::VectorXd q = q_of(b, rest.q);
    Eigen::VectorXd gradient = model.rate_weight * (q - bodies_[b].q_n);
    for (std::size_t f = terms_at_[b]; f < terms_at_[b + 1]; ++f) {
      const std::size_t own = terms_[f].index;
      const Eigen::VectorXd change = strain(rest.S[f], model.S0[own], is_periodic(*terms_[f].family));
      gradient.noalias() += rest.J[f].transpose() * model.regularizer_coefficients[own].cwiseProduct(change);
    }
    if (!model.hull.groups.empty()) {
      const Eigen::MatrixXd& basis = model.rest->basis();
      Eigen::VectorXd of_p = Eigen::VectorXd::Zero(basis.rows());
      model.hull.add_gradient(basis * q, of_p);
      gradient += basis.transpose() * of_p;
    }
    all.segment(q_at_[b], parameters(b)) = gradient;
  });
  return all;
}

Eigen::MatrixXd StepProblem::regularizer_gauss_newton(const RestPoint& rest) const {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(q_n_.size(), q_n_.size());
  each_body([&](std::size_t b) {
    if (parameters(b) == 0) return;
    const BodyModel& model = body(b);
    Eigen::MatrixXd R = model.rate_weight * Eigen::MatrixXd::Identity(parameters(b), parameters(b));
    for (std::size_t f = terms_at_[b]; f < terms_at_[b + 1]; ++f) {
      R += weighted_square(rest.J[f], model.regularizer_coefficients[terms_[f].index]);
    }
    if (!model.hull.groups.empty()) {
      const Eigen::MatrixXd& basis = model.rest->basis();
      Eigen::MatrixXd of_p = Eigen::MatrixXd::Zero(basis.rows(), basis.rows());
      model.hull.add_hessian(basis * q_of(b, rest.q), of_p);
      R += basis.transpose() * of_p * basis;
    }
    all.block(q_at_[b], q_at_[b], parameters(b), parameters(b)) = R;
  });
  return all;
}

void StepProblem::block_A(const DeformedPoint& at, const RestPoint& rest, const Eigen::VectorXd& lambda,
                          SymmetricMatrix& A) const {
  A.set_zero();
  each_body([&](std::size_t b) {
    const Eigen::VectorXd l = x_of(b, lambda);
    for (std::size_t f = terms_at_[b]; f < terms_at_[b + 1]; ++f) {
      const MeasureFamily& family = *terms_[f].family;
      const Eigen::VectorXd slope = stress_slope(f, at, rest);
      const Eigen::VectorXd ds = family.gather(Side::deformed, at.g[f], l);
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
      family.add_block_a(at.of(b), at.g[f], slope, stress(f, at, rest), dstress, l, A);
    }
    bodies_[b].contacts->add_block_a(at.of(b), l, body(b).contact_slots, A);
  });
  if (pairs_ != nullptr) pairs_->add_block_a(at.x, lambda, A);
}

Eigen::MatrixXd StepProblem::block_B(const DeformedPoint& at, const RestPoint& rest,
                                     const Eigen::VectorXd& lambda) const {
  Eigen::MatrixXd B = Eigen::MatrixXd::Zero(q_n_.size(), at.x.size());
  each_body([&](std::size_t b) {
    if (parameters(b) == 0) return;
    const Eigen::VectorXd l = x_of(b, lambda);
    Eigen::VectorXd row(dofs(b)), Hl;
    for (std::size_t f = terms_at_[b]; f < terms_at_[b + 1]; ++f) {
      const MeasureFamily& family = *terms_[f].family;
      const MeasureValues where = values(f, at, rest);
      family.hessian_products(at.of(b), l, Hl);
      const RowMatrixXd coupled = family.law().couple(where, rest.J[f]);
      RowMatrixXd rate;
      if (!family.law().quadratic()) {
        const Eigen::VectorXd ds = family.gather(Side::deformed, at.g[f], l);
        rate = family.law().couple_rate(where, ds, rest.J[f]);
      }
      for (Eigen::Index k = 0; k < parameters(b); ++k) {
        row.setZero();
        family.scatter(Side::deformed, Hl, coupled.col(k), row);
        if (rate.size() > 0) family.scatter(Side::deformed, at.g[f], rate.col(k), row);
        B.row(q_at_[b] + k).segment(x_at_[b], dofs(b)) += row.transpose();
      }
    }
  });
  return B;
}

Eigen::MatrixXd StepProblem::block_C(const DeformedPoint& at, const RestPoint& rest,
                                     const Eigen::VectorXd& lambda) const {
  Eigen::MatrixXd all = regularizer_gauss_newton(rest);
  each_body([&](std::size_t b) {
    if (parameters(b) == 0) return;
    const BodyModel& model = body(b);
    const Eigen::VectorXd l = x_of(b, lambda);
    Eigen::MatrixXd C = all.block(q_at_[b], q_at_[b], parameters(b), parameters(b));
    std::vector<Eigen::VectorXd> weights(model.elastic.size());
    for (std::size_t f = terms_at_[b]; f < terms_at_[b + 1]; ++f) {
      const MeasureFamily& family = *terms_[f].family;
      const std::size_t own = terms_[f].index;
      const MeasureValues where = values(f, at, rest);
      const RowMatrixXd ds = family.gather(Side::deformed, at.g[f], l);
      const Eigen::VectorXd change = strain(rest.S[f], model.S0[own], is_periodic(family));
      weights[own] = model.regularizer_coefficients[own].cwiseProduct(change) +
                     Eigen::VectorXd(family.law().couple_transposed(where, ds));
      if (!family.law().quadratic()) {
        C.noalias() += rest.J[f].transpose() * family.law().rest_curvature(where, ds.col(0), rest.J[f]);
      }
    }
    model.rest->add_hessians(model.elastic, q_of(b, rest.q), weights, C);
    all.block(q_at_[b], q_at_[b], parameters(b), parameters(b)) = C;
  });
  return all;
}

}  // namespace vivify::sim
