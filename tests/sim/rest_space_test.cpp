#include "sim/rest/rest_space.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

struct Cage {
  Cage() : mesh(small_box()), body(make_body_model(box_input(mesh), {})) {}
  TetMesh mesh;
  BodyModel body;
  const ShapeSpace& space = dynamic_cast<const ShapeSpace&>(*body.rest);
  // L p for displacements of the cage vertices.
  Vector moved(const Vector& p) const {
    const Matrix weights = multilinear_weights(mesh.V);
    Vector u = Vector::Zero(3 * mesh.V.rows());
    for (Eigen::Index i = 0; i < weights.rows(); ++i) {
      for (Eigen::Index c = 0; c < weights.cols(); ++c) {
        u.segment<3>(3 * i) += weights(i, c) * p.segment<3>(3 * c);
      }
    }
    return u;
  }
};

RowMatrixXd rows_of(const Vector& x) { return Eigen::Map<const RowMatrixXd>(x.data(), x.size() / 3, 3); }

// Displacements of the 8 cage vertices of multilinear_weights for a displacement field.
template <class Field>
Vector cage_motion(const Points& V, const Field& field) {
  const Box box = bounding_box(V);
  const Eigen::Vector3d margin = 0.1 * (box.max - box.min), low = box.min - margin, high = box.max + margin;
  Vector p(24);
  for (int c = 0; c < 8; ++c) {
    const Eigen::Vector3d corner(c & 1 ? high.x() : low.x(), c & 2 ? high.y() : low.y(),
                                 c & 4 ? high.z() : low.z());
    p.segment<3>(3 * c) = field(corner);
  }
  return p;
}

TEST(CageSpace, ReproducesLinearMotionsOfTheCage) {
  const Cage cage;
  CounterRng rng(1);
  Eigen::Matrix3d M;
  for (int k = 0; k < 9; ++k) M(k) = rng.uniform(-1, 1);
  const Eigen::Vector3d b = random_vector(3, 1, rng);
  const auto field = [&](const Eigen::Vector3d& X) -> Eigen::Vector3d { return M * X + b; };
  const Vector moved = cage.moved(cage_motion(cage.mesh.V, field));
  for (Eigen::Index i = 0; i < cage.mesh.V.rows(); ++i) {
    EXPECT_LE((moved.segment<3>(3 * i) - field(cage.mesh.V.row(i).transpose())).norm(), 1e-14);
  }
}

// A pose that the cage can take is taken.
TEST(CageSpace, TakesAPoseOfItsOwn) {
  const Cage cage;
  CounterRng rng(2);
  const Vector p = 0.05 * random_vector(24, 1, rng);
  BodyInput input = box_input(cage.mesh);
  input.examples = {{"bow", "", cage.mesh.V + rows_of(cage.moved(p))}};
  const BodyModel body = make_body_model(input, {});
  ASSERT_EQ(body.rest->poses().cols(), 1);
  EXPECT_LE((body.rest->poses().col(0) - p).norm(), 1e-10);
}

// One that it cannot take is approached by least squares, thirty times as closely where it moves nothing.
TEST(CageSpace, ComesNearestToAPoseThatItCannotTake) {
  const Cage cage;
  RowMatrixXd pose = cage.mesh.V;
  const Box box = bounding_box(cage.mesh.V);
  Vector weight(pose.rows());
  for (Eigen::Index i = 0; i < pose.rows(); ++i) {
    const double up = (pose(i, 1) - box.min.y()) / (box.max.y() - box.min.y());
    weight[i] = up < 1e-9 ? 30 : 1;
    pose(i, 0) += 0.2 * (box.max.y() - box.min.y()) * up * up;
  }
  BodyInput input = box_input(cage.mesh);
  input.examples = {{"lean", "", pose}};
  const BodyModel body = make_body_model(input, {});
  const RowMatrixXd missed = pose - cage.mesh.V - rows_of(cage.moved(body.rest->poses().col(0)));
  EXPECT_GT(missed.norm(), 1e-3);
  const Matrix gradient =
      multilinear_weights(cage.mesh.V).transpose() * weight.cwiseAbs2().asDiagonal() * missed;
  EXPECT_LE(gradient.norm(), 1e-10) << "the normal equations";
}

TEST(CageSpace, RemovesTheSixRigidMotionsAndNothingElse) {
  const Cage cage;
  const ShapeSpace& space = cage.space;
  EXPECT_EQ(space.free_parameters(), 18);
  const Matrix gram = space.basis().transpose() * space.basis();
  EXPECT_LE((gram - Matrix::Identity(18, 18)).norm(), 1e-13);
  // Rigid motions of the cage are orthogonal to the basis.
  for (int motion = 0; motion < 6; ++motion) {
    const auto field = [&](const Eigen::Vector3d& X) -> Eigen::Vector3d {
      const Eigen::Vector3d axis = Eigen::Vector3d::Unit(motion % 3);
      return motion < 3 ? axis : axis.cross(X);
    };
    const Vector p = cage_motion(cage.mesh.V, field);
    EXPECT_LE((space.basis().transpose() * p).norm(), 1e-12 * p.norm());
  }
  // What is removed is rigid: any p orthogonal to the basis changes no edge to first order.
  const Eigen::FullPivLU<Matrix> lu(space.basis().transpose());
  const Matrix removed = lu.kernel();
  ASSERT_EQ(removed.cols(), 6);
  const Vector X = flat(cage.mesh.V);
  for (int k = 0; k < 6; ++k) {
    const Vector u = cage.moved(removed.col(k));
    for (int i = 0; i < 27; ++i) {
      for (int j = 0; j < i; ++j) {
        const Eigen::Vector3d edge = X.segment<3>(3 * i) - X.segment<3>(3 * j),
                              du = u.segment<3>(3 * i) - u.segment<3>(3 * j);
        EXPECT_LE(std::abs(edge.dot(du)), 1e-12 * u.norm());
      }
    }
  }
}

TEST(CageSpace, FewerRigidMotionsAreRemovedWhenTheCageCannotMakeThem) {
  // One handle that scales the height: no rigid motion at all.
  const Vector X0 = flat(small_box().V);
  Matrix L = Matrix::Zero(X0.size(), 1);
  for (Eigen::Index i = 1; i < X0.size(); i += 3) L(i, 0) = X0[i];
  EXPECT_EQ(shape_changing_basis(X0, L, 3).cols(), 1);
  // Translations only.
  Matrix T = Matrix::Zero(X0.size(), 4);
  for (Eigen::Index i = 0; i < X0.size(); ++i) T(i, i % 3) = 1;
  T.col(3) = L;
  const Matrix basis = shape_changing_basis(X0, T, 3);
  ASSERT_EQ(basis.cols(), 1);
  EXPECT_NEAR(std::abs(basis(3, 0)), 1, 1e-12);
}

// A level rod sees only where along it the cage pulls and how far: all that is left is to stretch it.
TEST(CageSpace, RemovesParametersWithoutEffect) {
  const ModelEntry& rod = model_entry(settings(model_schema(), "{type: rod2d}"));
  BodyCase level{rod, rest_space_entry("cage"), small_meshes(2, 2).front()};
  level.mesh.mesh.V.col(1).setZero();
  BodyInput input = body_input(level);
  input.examples.clear();  // poses of a body with a height
  const Matrix across =
      (Matrix(1, 4) << 0.3, 0.3, 0.7, 0.7).finished();  // shares of the lower and upper corners
  for (Eigen::Index i = 0; i < input.cage_weights.rows(); ++i) {
    const double t = (level.mesh.mesh.V(i, 0) + 0.5) / 1.0;
    input.cage_weights.row(i) = across.cwiseProduct((Matrix(1, 4) << 1 - t, t, 1 - t, t).finished());
  }
  const BodyModel body = make_body_model(input, {});
  ASSERT_EQ(body.rest->free_parameters(), 1);
  const ShapeSpace& space = dynamic_cast<const ShapeSpace&>(*body.rest);
  const Vector stretch = space.L().col(0);
  for (Eigen::Index i = 0; i + 2 < stretch.size(); i += 2) {
    EXPECT_NEAR(stretch[i + 1], 0, 1e-14);
    const double slope =
        (stretch[i + 2] - stretch[i]) / (level.mesh.mesh.V(i / 2 + 1, 0) - level.mesh.mesh.V(i / 2, 0));
    EXPECT_GT(std::abs(slope), 0.1);
  }
}

}  // namespace
}  // namespace vivify::sim
