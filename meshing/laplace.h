// The Laplace equation on a tetrahedral mesh with prescribed values on its boundary.
#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "common/mesh.h"

namespace vivify::meshing {

// Piecewise-linear finite elements; factorised once, solved for any number of boundary values. The same bits
// for any number of threads.
class LaplaceProblem {
 public:
  // `prescribed` (distinct vertices, at least one in each component) have given values; all other vertices
  // that a tetrahedron uses are unknowns. Throws Error(numerical) when the matrix is not positive definite.
  LaplaceProblem(const TetMesh& mesh, const Eigen::VectorXi& prescribed);

  // values: #prescribed by k. Returns #V by k; rows of vertices that no tetrahedron uses are zero.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& values) const;

  Eigen::Index unknowns() const { return free_.size(); }

 private:
  Eigen::Index vertices_;
  Eigen::VectorXi prescribed_;
  Eigen::VectorXi free_;                  // vertices that are unknowns
  Eigen::SparseMatrix<double> coupling_;  // #free by #prescribed part of the stiffness matrix
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

}  // namespace vivify::meshing
