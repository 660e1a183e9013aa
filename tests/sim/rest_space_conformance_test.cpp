// Every rest space with every model: it starts at the rest shape, its derivatives are right, and every
// parameter that it keeps changes the shape.
#include <Eigen/SVD>

#include "tests/sim/conformance.h"

namespace vivify::sim {
namespace {

INSTANTIATE_TEST_SUITE_P(Every, RestSpaceConformance,
                         ::testing::ValuesIn(body_cases(elastic_models(), rest_spaces())), case_name);

struct Space {
  explicit Space(const BodyCase& tested)
      : body(make_body_model(body_input(tested), {}, tested.model, tested.space)), rng(3) {
    q = random_vector(body.rest->free_parameters(), 0.1 * body.rest->unit(), rng);
  }
  // The measures of all families, one after another.
  Vector measures(const Vector& at) const {
    std::vector<Vector> S;
    body.rest->measures(body.elastic, at, S, nullptr);
    return joined(S);
  }
  Matrix jacobian(const Vector& at) const {
    std::vector<Vector> S;
    std::vector<RowMatrixXd> J;
    body.rest->measures(body.elastic, at, S, &J);
    EXPECT_EQ(joined(S), measures(at));
    Matrix all(joined(S).size(), at.size());
    Eigen::Index row = 0;
    for (const RowMatrixXd& part : J) {
      all.middleRows(row, part.rows()) = part;
      row += part.rows();
    }
    EXPECT_EQ(row, all.rows());
    return all;
  }
  Matrix hessian(const Vector& at, const Vector& w) const {
    std::vector<Vector> weights;
    Eigen::Index row = 0;
    for (const auto& family : body.elastic) {
      weights.push_back(w.segment(row, family->value_count()));
      row += family->value_count();
    }
    Matrix C = Matrix::Zero(at.size(), at.size());
    body.rest->add_hessians(body.elastic, at, weights, C);
    return C;
  }
  static Vector joined(const std::vector<Vector>& parts) {
    Vector all;
    for (const Vector& part : parts) {
      all.conservativeResize(all.size() + part.size());
      all.tail(part.size()) = part;
    }
    return all;
  }

  BodyModel body;
  CounterRng rng;
  Vector q;
};

TEST_P(RestSpaceConformance, StartsAtTheRestShape) {
  const Space space(GetParam());
  const ElasticModel model =
      build_model(GetParam().model, space.body.mesh, GetParam().space.layout, body_input(GetParam()).model);
  const Vector X0 = stack(space.body.mesh.V, model.rest);
  std::vector<Vector> S0;
  for (const auto& family : model.families) family->values(Side::rest, X0, S0.emplace_back());
  const Vector expected = Space::joined(S0), zero = Vector::Zero(space.q.size());
  EXPECT_LE((space.measures(zero) - expected).norm(), 1e-15 * expected.norm());
  if (const auto* shapes = dynamic_cast<const ShapeSpace*>(space.body.rest.get())) {
    EXPECT_EQ(shapes->shape(zero), X0);
  }
}

TEST_P(RestSpaceConformance, JacobianAndHessians) {
  Space space(GetParam());
  const auto measures = [&](const Vector& q) { return space.measures(q); };
  const Matrix J = space.jacobian(space.q);
  const Vector d = random_vector(space.q.size(), 1, space.rng), w = random_vector(J.rows(), 1, space.rng);
  const double unit = space.body.rest->unit();
  EXPECT_LE(relative(J, differences(measures, space.q, 1e-6 * unit)), 1e-6);
  EXPECT_TRUE(converges(measures, space.q, d, J * d, 1e-3 * unit));
  const auto pulled_back = [&](const Vector& q) -> Vector { return space.jacobian(q).transpose() * w; };
  const Matrix C = space.hessian(space.q, w), differenced = differences(pulled_back, space.q, 1e-6 * unit);
  EXPECT_LE((C - differenced).norm(), 1e-6 * std::max(C.norm(), J.norm()));
  EXPECT_LE((C - C.transpose()).norm(), 1e-12 * std::max(C.norm(), J.norm()));
  EXPECT_TRUE(converges(pulled_back, space.q, d, C * d, 1e-3 * unit));
}

TEST_P(RestSpaceConformance, EveryKeptDirectionChangesTheShape) {
  const Space space(GetParam());
  const Matrix& basis = space.body.rest->basis();
  EXPECT_LE((basis.transpose() * basis - Matrix::Identity(basis.cols(), basis.cols())).norm(), 1e-13);
  Matrix J = space.jacobian(Vector::Zero(space.q.size()));
  for (Eigen::Index row = 0; row < J.rows(); ++row)
    J.row(row) /= std::max(J.row(row).norm(), 1e-9 * J.norm());
  const Vector singular = J.jacobiSvd().singularValues();
  ASSERT_GE(J.rows(), J.cols());
  EXPECT_GT(singular.minCoeff(), 1e-4 * singular.maxCoeff());
}

TEST_P(RestSpaceConformance, HullsGroupTheParameters) {
  const Space space(GetParam());
  EXPECT_GT(space.body.rest->unit(), 0);
  std::set<int> seen;
  for (const std::vector<int>& group : space.body.rest->groups()) {
    EXPECT_FALSE(group.empty());
    for (const int k : group) {
      EXPECT_TRUE(k >= 0 && k < space.body.rest->parameters());
      EXPECT_TRUE(seen.insert(k).second) << "in two groups";
    }
  }
}

}  // namespace
}  // namespace vivify::sim
