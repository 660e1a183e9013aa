// Reference numbers, computed here without any part of the simulation.
#pragma once

namespace vivify::validation {

// A clamped inextensible beam of length 1 and bending stiffness 1 under a dead load α = P L²/EI at its tip,
// across its rest direction: how far the tip moves across, and back along.
struct TipMotion {
  double across = 0, back = 0;
};
TipMotion elastica(double alpha);            // Runge–Kutta with shooting for the curvature at the clamp
TipMotion elastica_integrals(double alpha);  // elliptic integrals

// The first root of cos x cosh x = −1, squared: 3.516, the first frequency of a cantilever.
double cantilever_frequency();

// Self-weight buckling of a clamped column: ρ A g L³/EI = 7.837.
double self_weight_buckling();         // shooting on θ'' = −λ s θ
double self_weight_buckling_bessel();  // (9/4) j², j the first root of the Bessel function J of order −1/3

}  // namespace vivify::validation
