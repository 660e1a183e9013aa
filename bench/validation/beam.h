// Slender beams along x of every model that bends, clamped at x = 0, with their small-strain constants.
#pragma once

#include "bench/validation/bodies.h"

namespace vivify::validation {

struct Beam {
  sim::BodyModel body;
  std::vector<bool> held;  // #V: the clamp
  Vector X;                // d #V, at rest
  Vector tip;              // #V: shares of a force on the end section; they sum to 1
  double length = 0;       // m
  double EI = 0;           // N m², of the model on this mesh, in the limit of fine meshes
  double GA = 0;           // N: shear force per angle, with the shear coefficient 5/6; infinite without shear
  double EA = 0;           // N
  double line_density = 0;  // kg/m

  // A force of size 1 on the end section along an axis, d #V.
  Vector tip_force(int axis) const;
  // Mean displacement of the end section.
  double tip_motion(const Vector& x, int axis) const { return tip_force(axis).dot(x - X); }
  // Weight for gravity 1 along an axis.
  Vector weight(int axis) const;
};

// Cells count over the height of a solid, over the width of a shell and over the length of a rod. The height
// of a solid and the width of a shell are `length / slenderness`.
Beam make_beam(const std::string& model, int cells, double slenderness,
               const std::string& scaling = "consistent");

// The models that bend.
std::vector<std::string> bending_models();

// Stiffness against uniform strain of the vertices, per volume (Pa; N/m in the plane): 3 by 3 or 6 by 6 in
// Voigt's order with engineering shear. A solid of simplified tetrahedra has the symmetry of its lattice.
Matrix uniform_strain_stiffness(const sim::BodyModel& body);

}  // namespace vivify::validation
