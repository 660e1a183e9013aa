// The optimisation problem (5) of one time step, as functions and their derivatives and nothing else:
//   min over x, q of ½ |G x − s|² + r(q)   s.t.   c(x, q) = M (x − x̃)/h² + ∂W/∂x(X(q), x) + ∂U_contact/∂x =
//   0,
// with x̃ = x_n + h v_n + h² g⃗ (implicit Euler, equation (3)) and p = basis · q. Damping adds the potential
// ½ (β/h) c (s(x) − s(x_n))² to every elastic term: its forces are internal, so they keep momentum.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/body_model.h"
#include "sim/control/goal.h"

namespace vivify::sim {

// The rest shape at one q: measures, and (on request) their derivatives with respect to q.
struct RestPoint {
  Eigen::VectorXd q;
  std::vector<Eigen::VectorXd> S;  // per family: #values
  std::vector<RowMatrixXd> J;      // per family: ∂S/∂q, #values by #q; empty unless asked for
  double regularizer = 0;          // r(q), J
  double smallest_element = 1;     // min V_e / V̄_e of the rest elements
};

// The deformed shape at one x: measures and gradients per family.
struct DeformedPoint {
  Eigen::VectorXd x;
  std::vector<Eigen::VectorXd> s;
  std::vector<Eigen::VectorXd> g;  // in the layout of the family
};

class StepProblem {
 public:
  // `x_n`, `q_n`: state of the last step; `x_tilde` is x̃. All references must outlive the problem.
  StepProblem(const BodyModel& body, const ContactSet& contacts, const Goals& goals,
              const Eigen::VectorXd& x_n, Eigen::VectorXd x_tilde, Eigen::VectorXd q_n, double h);

  const BodyModel& body() const { return body_; }
  const Goals& goals() const { return goals_; }
  const ContactSet& contacts() const { return contacts_; }
  const Eigen::VectorXd& q_n() const { return q_n_; }

  RestPoint rest_point(const Eigen::VectorXd& q, bool with_derivatives) const;
  DeformedPoint deformed_point(const Eigen::VectorXd& x) const;

  // ½ |G x − s|² + r(q), J.
  double objective(const Eigen::VectorXd& x, const RestPoint& rest) const;
  // Incremental potential whose gradient with respect to x is c, J.
  double potential(const DeformedPoint& at, const RestPoint& rest) const;
  // c, N.
  Eigen::VectorXd residual(const DeformedPoint& at, const RestPoint& rest) const;
  // Minus the internal forces, elastic and damping, N.
  Eigen::VectorXd internal_gradient(const DeformedPoint& at, const RestPoint& rest) const;
  // W, J.
  double elastic_energy(const DeformedPoint& at, const RestPoint& rest) const;
  // D = ∂c/∂x.
  void stiffness(const DeformedPoint& at, const RestPoint& rest, SymmetricMatrix& D) const;
  // Smallest v_e / V̄_e of the deformed elements (of bodies without areas or volumes: l / L̄ of the edges).
  double smallest_element(const DeformedPoint& at) const;

  // E = ∂c/∂q is never formed: products with it, and with its transpose. `rest` needs derivatives.
  Eigen::MatrixXd multiply_E(const DeformedPoint& at, const RestPoint& rest, const Eigen::MatrixXd& dq) const;
  Eigen::MatrixXd multiply_Et(const DeformedPoint& at, const RestPoint& rest, const RowMatrixXd& Y) const;

  Eigen::VectorXd regularizer_gradient(const RestPoint& rest) const;
  Eigen::MatrixXd regularizer_gauss_newton(const RestPoint& rest) const;

  // Exact blocks of (13) for the multiplier λ. A comes without the goals' part GᵀG, which is of low rank.
  void block_A(const DeformedPoint& at, const RestPoint& rest, const Eigen::VectorXd& lambda,
               SymmetricMatrix& A) const;
  Eigen::MatrixXd block_B(const DeformedPoint& at, const RestPoint& rest,
                          const Eigen::VectorXd& lambda) const;  // #q by n
  Eigen::MatrixXd block_C(const DeformedPoint& at, const RestPoint& rest,
                          const Eigen::VectorXd& lambda) const;  // #q by #q

  // M/h² on the diagonal, added `scale` times: makes an indefinite D definite for a descent direction.
  void add_inertia(double scale, SymmetricMatrix& D) const;

 private:
  double smallest_ratio(const std::vector<Eigen::VectorXd>& measures) const;
  MeasureValues values(std::size_t f, const DeformedPoint& at, const RestPoint& rest) const;
  // ∂w/∂s and ∂²w/∂s² of a family, with damping.
  Eigen::VectorXd stress(std::size_t f, const DeformedPoint& at, const RestPoint& rest) const;
  Eigen::VectorXd stress_slope(std::size_t f, const DeformedPoint& at, const RestPoint& rest) const;

  const BodyModel& body_;
  const ContactSet& contacts_;
  const Goals& goals_;
  Eigen::VectorXd x_tilde_, q_n_;
  Eigen::VectorXd inertia_;           // M/h² per degree of freedom, kg/s²
  double damping_ = 0;                // β/h
  std::vector<Eigen::VectorXd> s_n_;  // per family: s(x_n); empty without damping
};

}  // namespace vivify::sim
