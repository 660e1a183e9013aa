#include "meshing/laplace.h"

#include <gtest/gtest.h>

#include <functional>

#include "common/error.h"
#include "tests/meshing/cage_shapes.h"

namespace vivify::meshing {
namespace {

using Field = std::function<double(const Eigen::RowVector3d&)>;

Eigen::VectorXi cube_surface(const TetMesh& mesh) {
  std::vector<int> nodes;
  for (int v = 0; v < mesh.V.rows(); ++v) {
    if (mesh.V.row(v).minCoeff() < 1e-9 || mesh.V.row(v).maxCoeff() > 1 - 1e-9) nodes.push_back(v);
  }
  return Eigen::Map<Eigen::VectorXi>(nodes.data(), static_cast<Eigen::Index>(nodes.size()));
}

Eigen::VectorXd sample(const Field& field, const Points& V) {
  Eigen::VectorXd values(V.rows());
  for (Eigen::Index v = 0; v < V.rows(); ++v) values[v] = field(V.row(v));
  return values;
}

// Largest error in an uneven mesh of n^3 cells (a smooth distortion, so that no symmetry hides an error).
double cube_error(int n, const Field& exact) {
  TetMesh mesh = shapes::cube_tets(n);
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
    const Eigen::RowVector3d x = mesh.V.row(v);
    const double bump = 8 * (x.array() * (1 - x.array())).prod();
    mesh.V.row(v) += bump * Eigen::RowVector3d(0.3, -0.2, 0.25);
  }
  EXPECT_GT(tet_volumes(mesh).minCoeff(), 0);
  const Eigen::VectorXi surface = cube_surface(mesh);
  const Eigen::VectorXd values = sample(exact, mesh.V);
  const LaplaceProblem problem(mesh, surface);
  const Eigen::VectorXd given = values(surface);
  return (problem.solve(given) - values).cwiseAbs().maxCoeff();
}

void expect_second_order(const Field& exact) {
  const double coarse = cube_error(4, exact), middle = cube_error(8, exact), fine = cube_error(16, exact);
  EXPECT_GT(coarse, 1e-4);  // the test can fail
  EXPECT_NEAR(std::log2(coarse / middle), 2, 0.35) << coarse << " " << middle;
  EXPECT_LT(fine, 1e-3);
  EXPECT_NEAR(std::log2(middle / fine), 2, 0.2) << middle << " " << fine;
}

TEST(LaplaceProblem, LinearFieldsAreExact) {
  EXPECT_LT(cube_error(5, [](const auto& x) { return 3 - 2 * x[0] + x[1] + 5 * x[2]; }), 1e-13);
}

// The hat function of a cube corner with bilinear values on the faces.
TEST(LaplaceProblem, BilinearFacesGiveTheTrilinearSolution) {
  expect_second_order([](const auto& x) { return (1 - x[0]) * x[1] * x[2]; });
}

TEST(LaplaceProblem, HarmonicPolynomialXyz) {
  expect_second_order([](const auto& x) { return (x[0] - 0.3) * (x[1] + 0.2) * (x[2] - 0.6); });
}

TEST(LaplaceProblem, HarmonicPolynomialX2MinusY2) {
  expect_second_order([](const auto& x) { return x[0] * x[0] - x[1] * x[1]; });
}

TEST(LaplaceProblem, ColumnsAreIndependent) {
  const TetMesh mesh = shapes::cube_tets(4);
  const Eigen::VectorXi surface = cube_surface(mesh);
  const LaplaceProblem problem(mesh, surface);
  EXPECT_EQ(problem.unknowns(), 27);
  const Eigen::MatrixXd values = Eigen::MatrixXd::Random(surface.size(), 5);
  const Eigen::MatrixXd all = problem.solve(values);
  for (int k = 0; k < 5; ++k) EXPECT_EQ(all.col(k), problem.solve(values.col(k)).col(0));
}

TEST(LaplaceProblem, APartWithoutPrescribedValuesIsAnError) {
  TetMesh mesh = shapes::cube_tets(2);
  EXPECT_THROW(LaplaceProblem(mesh, Eigen::VectorXi()), Error);
}

}  // namespace
}  // namespace vivify::meshing
