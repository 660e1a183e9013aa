// Motion goals, equations (6)–(10) of Coros et al. 2012: scalar functions that are linear in the positions,
// with targets for value and rate. The printed equation (9) has wrong signs; from (8) it follows that
//   s = h / (h k_p + k_d) · (k_p s_x + k_d s_v + (k_d / h) Σ w_j x_nj),   w = (h k_p + k_d) / h.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace vivify::sim {

// One scalar goal k_p (a·x − s_x) + k_d (a·v − s_v) with v = (x − x_n) / h.
struct Goal {
  Eigen::VectorXd a;  // d #V: weights of the coordinates
  double kp = 0;      // weight of the value
  double kd = 0;      // weight of the rate
  double sx = 0;      // target of the value
  double sv = 0;      // target of the rate
};

// All goals of one step in the form ½ |G x − s|².
struct Goals {
  Eigen::MatrixXd G;  // #goals by d #V, rows scaled by their weight (10)
  Eigen::VectorXd s;  // #goals

  Eigen::VectorXd residual(const Eigen::VectorXd& x) const { return G * x - s; }
  int size() const { return static_cast<int>(s.size()); }
};

// Goals of the step from x_n with step size h. Goals without weight are left out, and those that a body of
// the plane cannot follow.
Goals make_goals(const std::vector<Goal>& goals, const Eigen::VectorXd& x_n, double h);

// Along `direction` (unit), the centre of mass: a·x = direction · Σ m_i x_i / Σ m_i. `mass` is #V; vertices
// have `dimension` coordinates.
Eigen::VectorXd centre_of_mass_weights(const Eigen::VectorXd& mass, const Eigen::Vector3d& direction,
                                       int dimension = 3);

// About `axis` (unit), the angular velocity of the body as a whole: the rate a·v is axis · I⁻¹ Σ m_i r_i ×
// v_i, with the inertia tensor I and the arms r_i = x_i − centre at `x_n`. The value a·x means nothing; use
// k_p = 0.
Eigen::VectorXd spin_weights(const Eigen::VectorXd& mass, const Eigen::VectorXd& x_n,
                             const Eigen::Vector3d& axis);

}  // namespace vivify::sim
