// The Laplace equation on a triangle mesh in the plane or a tetrahedral mesh, with prescribed values on its
// boundary.
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
  // that an element uses are unknowns. Throws Error(numerical) when the matrix is not positive definite.
  LaplaceProblem(const TetMesh& mesh, const Eigen::VectorXi& prescribed);
  LaplaceProblem(const Points2& V, const Triangles& F, const Eigen::VectorXi& prescribed);

  // values: #prescribed by k. Returns #V by k; rows of vertices that no element uses are zero.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& values) const;

  Eigen::Index unknowns() const { return free_.size(); }

 private:
  template <int kDim>
  void assemble(const Eigen::Matrix<double, Eigen::Dynamic, kDim, Eigen::RowMajor>& V,
                const Eigen::Matrix<int, Eigen::Dynamic, kDim + 1, Eigen::RowMajor>& E,
                const Eigen::VectorXd& sizes);

  Eigen::Index vertices_;
  Eigen::VectorXi prescribed_;
  Eigen::VectorXi free_;                  // vertices that are unknowns
  Eigen::SparseMatrix<double> coupling_;  // #free by #prescribed part of the stiffness matrix
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
};

}  // namespace vivify::meshing
