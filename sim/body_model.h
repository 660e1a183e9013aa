// All of a body that never changes during a run: rest mesh, mass, elasticity, rest space, contact points,
// patterns.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "common/mesh.h"
#include "sim/contact/contact_set.h"
#include "sim/elastic/models.h"
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
  TetMesh mesh;          // at rest, as placed in the scene
  Eigen::VectorXd mass;  // #V, kg
  double height = 0;     // m
  double weight = 0;     // N

  ElasticModel elastic;
  RestSpace rest;
  std::vector<Eigen::VectorXd> S0;                        // per family: measures of X₀
  std::vector<Eigen::VectorXd> regularizer_coefficients;  // per family, of W_reg (11)
  double rate_weight = 0;                                 // ρ of ½ ρ |p − p_n|², J/m²

  ContactPoints contact_points;
  ContactParameters contact;

  std::unique_ptr<SymmetricPattern> pattern;
  std::vector<int> contact_slots;   // places of the 12 by 12 block of each contact point
  std::vector<int> diagonal_slots;  // 3 #V
  SolverSettings solver;

  int dofs() const { return static_cast<int>(3 * mesh.V.rows()); }
};

}  // namespace vivify::sim
