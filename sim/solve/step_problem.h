// The optimisation problem (5) of one time step, as functions and their derivatives and nothing else:
//   min over x, q of ½ |G x − s|² + r(q)
//   s.t.  c(x, q) = M (x − x̃)/h² + ∂W/∂x(X(q), x) + ∂U_contact/∂x + ∂U_handles/∂x = 0,
// with x̃ = x_n + h v_n + h² g⃗ (implicit Euler, equation (3)) and p = basis · q. Damping adds the potential
// ½ (β/h) c (s(x) − s(x_n))² to every elastic term: its forces are internal, so they keep momentum.
// Bodies in contact are one problem: x and q are those of all bodies in a row, and the contacts between them
// couple their rows of c. The rest shape of a body may be given instead of sought; then it has no part in q.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "sim/body_model.h"
#include "sim/contact/pair_contacts.h"
#include "sim/control/goal.h"
#include "sim/handles.h"

namespace vivify::sim {

// The rest shapes at one q: measures, and (on request) their derivatives with respect to q.
struct RestPoint {
  Eigen::VectorXd q;
  std::vector<Eigen::VectorXd> S;  // per family of all bodies: #values
  std::vector<RowMatrixXd> J;      // per family: ∂S/∂q, #values by #q of its body; empty unless asked for
  double regularizer = 0;          // r(q), J
  double smallest_element = 1;     // min V_e / V̄_e of the rest elements that depend on q
};

// The deformed shapes at one x: measures and gradients per family of all bodies.
struct DeformedPoint {
  Eigen::VectorXd x;
  std::vector<Eigen::VectorXd> parts;  // x of each body, when there are several
  std::vector<Eigen::VectorXd> s;
  std::vector<Eigen::VectorXd> g;  // in the layout of the family

  const Eigen::VectorXd& of(std::size_t body) const { return parts.empty() ? x : parts[body]; }
};

// One body's part of a step.
struct BodyStep {
  const BodyModel* body;
  const ContactSet* contacts;             // with colliders
  Eigen::VectorXd x_n;                    // state of the last step
  Eigen::VectorXd x_tilde;                // x̃
  Eigen::VectorXd q_n;                    // rest parameters of the last step
  std::optional<Eigen::VectorXd> q = {};  // given rest parameters
  const Hold* hold = nullptr;             // of its handles
};

class StepProblem {
 public:
  // `goals` are of the x of all bodies; `pairs` may be null. What is referred to must outlive the problem,
  // and the bodies must be bound to the pattern that they share.
  StepProblem(std::vector<BodyStep> bodies, const PairContacts* pairs, const Goals& goals, double h);
  // Of one body.
  StepProblem(const BodyModel& body, const ContactSet& contacts, const Goals& goals,
              const Eigen::VectorXd& x_n, Eigen::VectorXd x_tilde, Eigen::VectorXd q_n, double h);

  std::size_t body_count() const { return bodies_.size(); }
  const BodyModel& body(std::size_t b = 0) const { return *bodies_[b].body; }
  Eigen::VectorXd x_of(std::size_t b, const Eigen::VectorXd& x) const { return x.segment(x_at_[b], dofs(b)); }
  // The rest parameters of a body, sought or given.
  Eigen::VectorXd q_of(std::size_t b, const Eigen::VectorXd& q) const;
  const Goals& goals() const { return goals_; }
  const Eigen::VectorXd& q_n() const { return q_n_; }
  const SolverSettings& solver() const;  // of the first body whose rest shape is sought
  double energy_unit() const;  // weight times height, of the smallest body whose rest shape is sought, J

  // Largest component of forces, over the weight of the body that they act on.
  double relative_force(const Eigen::VectorXd& c) const;
  // Largest component of displacements, over the height of the body that is moved.
  double relative_length(const Eigen::VectorXd& dx) const;
  // Largest change of a rest parameter, in units of its rest space.
  double relative_change(const Eigen::VectorXd& dq) const;

  RestPoint rest_point(const Eigen::VectorXd& q, bool with_derivatives) const;
  DeformedPoint deformed_point(const Eigen::VectorXd& x) const;

  // ½ |G x − s|² + r(q), J.
  double objective(const Eigen::VectorXd& x, const RestPoint& rest) const;
  // Incremental potential whose gradient with respect to x is c, J.
  double potential(const DeformedPoint& at, const RestPoint& rest) const;
  // c, N.
  Eigen::VectorXd residual(const DeformedPoint& at, const RestPoint& rest) const;
  // Minus the internal forces of a body, elastic and damping, N.
  Eigen::VectorXd internal_gradient(std::size_t body, const DeformedPoint& at, const RestPoint& rest) const;
  // Sum of the forces of a body's handles on it, N.
  Eigen::Vector3d handle_force(std::size_t body, const DeformedPoint& at) const;
  // W of a body, J.
  double elastic_energy(std::size_t body, const DeformedPoint& at, const RestPoint& rest) const;
  // D = ∂c/∂x.
  void stiffness(const DeformedPoint& at, const RestPoint& rest, SymmetricMatrix& D) const;
  // Smallest v_e / V̄_e of the deformed elements (of bodies without areas or volumes: l / L̄ of the edges).
  double smallest_element(const DeformedPoint& at) const;
  double smallest_element(std::size_t body, const DeformedPoint& at) const;
  // The same of a body's rest elements, and the sum of their sizes over that of X₀ (rods: of lengths; shells:
  // of squared lengths).
  double smallest_rest_element(std::size_t body, const RestPoint& rest) const;
  double rest_volume(std::size_t body, const RestPoint& rest) const;

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
  // A family of a body.
  struct Term {
    const MeasureFamily* family;
    std::size_t body;
    std::size_t index;  // among the families of its body
  };
  Eigen::Index dofs(std::size_t b) const { return x_at_[b + 1] - x_at_[b]; }
  Eigen::Index parameters(std::size_t b) const { return q_at_[b + 1] - q_at_[b]; }
  bool is_free(std::size_t b) const { return !bodies_[b].q; }
  // Calls function(b) for every body; on several threads when there are several.
  void each_body(const std::function<void(std::size_t)>& function) const;
  double smallest_ratio(std::size_t body, const std::vector<Eigen::VectorXd>& measures) const;
  // Elastic part of r(q) of a body.
  double regularizer(std::size_t body, const std::vector<Eigen::VectorXd>& S) const;
  MeasureValues values(std::size_t f, const DeformedPoint& at, const RestPoint& rest) const;
  // ∂w/∂s and ∂²w/∂s² of a family, with damping.
  Eigen::VectorXd stress(std::size_t f, const DeformedPoint& at, const RestPoint& rest) const;
  Eigen::VectorXd stress_slope(std::size_t f, const DeformedPoint& at, const RestPoint& rest) const;

  std::vector<BodyStep> bodies_;
  const PairContacts* pairs_;
  const Goals& goals_;
  std::vector<Eigen::Index> x_at_, q_at_;  // where the unknowns of each body begin, and the ends
  std::vector<Term> terms_;                // families of all bodies in a row
  std::vector<std::size_t> terms_at_;      // where those of each body begin, and the end
  std::vector<Eigen::VectorXd> fixed_S_;   // per family, of bodies whose rest shape is given
  double fixed_regularizer_ = 0;           // of these bodies
  Eigen::VectorXd x_tilde_, q_n_;
  Eigen::VectorXd inertia_;  // M/h² per degree of freedom, kg/s²
  double h_;
  std::vector<Eigen::VectorXd> s_n_;  // per family: s(x_n); empty without damping
};

}  // namespace vivify::sim
