// One-sided normal force of a contact: U(d) = (k/3) max(0, δ − d)³ of the distance d to the contact plane.
// The force k (δ − d)² never pulls, and the Hessian is continuous at the onset (the paper's spring is
// quadratic and sticks).
#pragma once

#include <algorithm>

namespace vivify::sim {

struct NormalForce {
  double stiffness;  // k, N/m²
  double layer;      // δ, m

  double depth(double d) const { return std::max(0.0, layer - d); }
  double energy(double d) const { return stiffness / 3 * depth(d) * depth(d) * depth(d); }
  double force(double d) const { return stiffness * depth(d) * depth(d); }   // −U'
  double second(double d) const { return 2 * stiffness * depth(d); }         // U''
  double third(double d) const { return d < layer ? -2 * stiffness : 0.0; }  // U'''
};

}  // namespace vivify::sim
