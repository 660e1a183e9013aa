// Elastic constants from Young's modulus and Poisson's ratio, and the keys of the scene file for them.
#pragma once

#include "common/schema.h"

namespace vivify::sim {

// Stiffness of the stretch measure (k_l), of the size measure (k_a, k_v) and of bending (k_b).
struct Stiffness {
  double stretch = 0;
  double size = 0;
  double bending = 0;
};

// The plane solid: μ = k_l/2, λ = k_a (plane stress); Young's modulus in N/m.
Stiffness plane_solid_stiffness(const Value& material);
// Green strain and volume: μ = k_l/2, λ = k_v.
Stiffness stvk_stiffness(const Value& material);
// The simplified tetrahedron: edges alone are a solid of Poisson's ratio 1/4, averaged over directions
// μ = λ = 4 k_l/15; k_v adds to λ. Throws Error(usage) for a ratio below 1/4.
Stiffness simplified_solid_stiffness(const Value& material);
// A rod: EA = 4 k_l, EI = k_b, with EA = Y t and EI = Y t³/12 for thickness t (Y in N/m: per unit of depth).
Stiffness rod_stiffness(const Value& material);
// A shell: edges alone are a sheet of Poisson's ratio 1/3 with Y t = 4 k_l/3; hinges bend a strip of
// equilateral triangles with 8 k_b/3 per width.
Stiffness shell_stiffness(const Value& material);

// Adds `young` and `poisson` (or `thickness` for rods and shells) to a material.
Schema with_poisson(Schema material, const char* young_unit);
Schema with_thickness(Schema material, const char* young_unit);

}  // namespace vivify::sim
