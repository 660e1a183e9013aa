// All of a body that never changes during a run: rest mesh, mass, elasticity, rest space, contact points,
// patterns.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "common/error.h"
#include "common/mesh.h"
#include "sim/contact/contact_set.h"
#include "sim/contact/contact_surface.h"
#include "sim/elastic/models.h"
#include "sim/rest/hull.h"
#include "sim/rest/rest_space.h"
#include "sim/solve/sparse_matrix.h"

namespace vivify::sim {

struct SolverSettings {
  std::string method = "sqp";  // sqp | reduced
  bool exact_hessian = false;  // the full blocks A, B, C of (13) instead of Gauss–Newton
  int max_iterations = 50;
  double decrement = 1e-4;   // stop at this Newton decrement, in units of weight · height
  double small_gain = 1e-4;  // relative; two such gains in a row end the iteration
};

struct BodyModel {
  std::string name;
  Location where;        // its place in the scene file, for messages
  SimMesh mesh;          // at rest, as placed in the scene
  Eigen::VectorXd mass;  // #V, kg
  double height = 0;     // m
  double weight = 0;     // N

  ElasticFamilies elastic;
  double damping = 0;  // Rayleigh's β, s
  std::unique_ptr<RestSpace> rest;
  std::vector<Eigen::VectorXd> S0;                        // per family: measures of X₀ (#values)
  std::vector<Eigen::VectorXd> regularizer_coefficients;  // per family (#values), of W_reg (11)
  double rate_weight = 0;  // ρ of ½ ρ |p − p_n|², J per squared unit of p
  Hull hull;               // of the examples

  ContactPoints contact_points;
  ContactParameters contact;

  ContactSurface surface;  // that touches other bodies

  std::unique_ptr<SymmetricPattern> pattern;  // of the body alone
  // Where the entries of the body lie in the pattern that it is bound to.
  const SymmetricPattern* bound_to = nullptr;
  std::vector<int> contact_slots;   // places of the block of each contact point
  std::vector<int> diagonal_slots;  // d #V
  SolverSettings solver;

  // Declares the entries of the body's stiffness matrix in a pattern where its vertices begin at
  // `first_vertex`, and remembers where they lie there.
  void reserve(SymmetricPattern& shared, int first_vertex) const;
  void bind(const SymmetricPattern& shared, int first_vertex);

  int dimension() const { return mesh.dimension(); }
  int dofs() const { return static_cast<int>(mesh.V.size()); }
};

}  // namespace vivify::sim
