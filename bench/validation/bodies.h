// Bodies of the validation problems, their equilibria and their vibrations.
#pragma once

#include "sim/body.h"
#include "sim/solve/static_solve.h"

namespace vivify::validation {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

// Settings given as YAML, checked and completed. Throws the first Error.
Value settings(const Schema& schema, const std::string& yaml);

// What make_body_model needs besides the mesh and the model (YAML); without contact and controller.
sim::BodyInput body_input(const SimMesh& mesh, const std::string& model,
                          const std::string& rest_space = "full");
sim::BodyModel body(const SimMesh& mesh, const std::string& model);

// A small body of every model: sample_mesh is a block or a strip of about 20 elements, roughened.
struct Sample {
  std::string model;  // name
  SimMesh mesh;
  std::string yaml;  // of the model
};
std::vector<Sample> samples();

// Elastic energy, its gradient, and its Hessian at x for the rest measures S.
double energy(const sim::BodyModel& body, const std::vector<Vector>& S, const Vector& x);
Vector gradient(const sim::BodyModel& body, const std::vector<Vector>& S, const Vector& x);
void stiffness(const sim::BodyModel& body, const std::vector<Vector>& S, const Vector& x,
               sim::SymmetricMatrix& D);
// The rows and columns of held vertices replaced by those of the identity times `diagonal`.
void hold(const std::vector<bool>& held, int dimension, double diagonal, sim::SymmetricMatrix& D);

// Equilibrium with the body's own rest shape from x under constant forces, solved until no force exceeds
// `tolerance` times the sum of all applied, or what rounding leaves. Throws Error(numerical) when it is not
// reached.
Vector equilibrium(const sim::BodyModel& body, const Vector& x, const Vector& force,
                   const std::vector<bool>& held, double tolerance = 1e-7);

// Lowest angular frequency (rad/s) of the body at rest with held vertices, by inverse iteration.
double lowest_frequency(const sim::BodyModel& body, const std::vector<bool>& held);

// Resultant of forces about the origin: its torque has one component in the plane, three in space.
struct Resultant {
  Vector force, torque;
};
Resultant resultant(const Vector& x, const Vector& forces, int dimension);

}  // namespace vivify::validation
