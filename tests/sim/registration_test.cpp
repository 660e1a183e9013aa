// Registration of example poses, element by element, and what the example spaces make of them.
#include "sim/rest/registration.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <numbers>

#include "tests/sim/conformance.h"

namespace vivify::sim {
namespace {

// A model's rest elements, and their points at rest.
struct Elements {
  explicit Elements(const ModelCase& tested)
      : mesh(tested.mesh.mesh),
        points(build_model(tested.model, mesh, RestLayout::incompatible,
                           settings(model_schema({&tested.model, 1}),
                                    "{type: " + std::string(tested.model.name) + "}"))
                   .rest),
        d(mesh.dimension()),
        X0(stack(mesh.V, points)) {}
  Vector registered(const RowMatrixXd& V) const {
    return register_elements(stack(V, points), X0, points, d, "pose");
  }
  int count() const { return static_cast<int>(points.element_begin.size()) - 1; }
  // The points of an element, a column each.
  Matrix of(const Vector& X, int e) const {
    const int begin = points.element_begin[static_cast<std::size_t>(e)],
              end = points.element_begin[static_cast<std::size_t>(e) + 1];
    return X.segment(d * begin, d * (end - begin)).reshaped(d, end - begin);
  }
  SimMesh mesh;
  RestPoints points;
  int d;
  Vector X0;
};

RowMatrixXd moved_rows(const Matrix& R, const Vector& b, const RowMatrixXd& V) {
  return (V * R.transpose()).rowwise() + b.transpose();
}

class Registration : public ::testing::TestWithParam<ModelCase> {};
INSTANTIATE_TEST_SUITE_P(Every, Registration, ::testing::ValuesIn(model_cases(elastic_models())), model_name);

TEST_P(Registration, RemovesRigidMotions) {
  const Elements elements(GetParam());
  CounterRng rng(1);
  for (int trial = 0; trial < 5; ++trial) {
    const Matrix R = random_rotation(elements.d, rng);
    const Vector b = random_vector(elements.d, 1, rng);
    EXPECT_LE(relative(elements.registered(moved_rows(R, b, elements.mesh.V)), elements.X0), 1e-13);
    for (const ExamplePose& pose : smooth_poses(elements.mesh)) {
      const Vector registered = elements.registered(pose.V);
      EXPECT_LE(relative(elements.registered(moved_rows(R, b, pose.V)), registered), 1e-12) << pose.name;
      EXPECT_GT((registered - elements.X0).norm(), 0.01) << pose.name;
      // Registered twice is registered once.
      EXPECT_LE(relative(register_elements(registered, elements.X0, elements.points, elements.d, "pose"),
                         registered),
                1e-13);
    }
  }
}

// What is left of an element is a stretch without rotation about the same centre; round a centre edge, that
// edge keeps its direction and its middle.
TEST_P(Registration, AlignsEveryElement) {
  const Elements elements(GetParam());
  for (const ExamplePose& pose : smooth_poses(elements.mesh)) {
    const Vector X = elements.registered(pose.V), posed = stack(pose.V, elements.points);
    for (int e = 0; e < elements.count(); ++e) {
      const Matrix from = elements.of(elements.X0, e), to = elements.of(X, e),
                   original = elements.of(posed, e);
      for (Eigen::Index i = 0; i < to.cols(); ++i) {
        for (Eigen::Index j = 0; j < i; ++j) {
          EXPECT_NEAR((to.col(i) - to.col(j)).norm(), (original.col(i) - original.col(j)).norm(), 1e-14);
        }
      }
      if (elements.points.centre_edge) {
        const Vector a = from.col(1) - from.col(0), b = to.col(1) - to.col(0);
        EXPECT_NEAR(a.dot(b), a.norm() * b.norm(), 1e-14);
        EXPECT_LE((from.leftCols(2).rowwise().mean() - to.leftCols(2).rowwise().mean()).norm(), 1e-14);
        // The length of a centre edge is linear in p.
        for (const double p : {0.25, 0.6}) {
          EXPECT_NEAR((a + p * (b - a)).norm(), a.norm() + p * (b.norm() - a.norm()), 1e-14);
        }
      } else {
        const Matrix S0 = from.rightCols(elements.d).colwise() - from.col(0).eval();
        const Matrix S = to.rightCols(elements.d).colwise() - to.col(0).eval();
        const Matrix F = S * S0.inverse();
        EXPECT_LE((F - F.transpose()).norm(), 1e-12);
        EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix>(F).eigenvalues().minCoeff(), 0);
        EXPECT_LE((from.rowwise().mean() - to.rowwise().mean()).norm(), 1e-14);
      }
    }
  }
}

TEST_P(Registration, RefusesElementsThatHaveNoRotationByName) {
  const Elements elements(GetParam());
  const auto refuses = [&](const RowMatrixXd& V, int element) {
    try {
      elements.registered(V);
      ADD_FAILURE() << "the pose was accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::geometry);
      const std::string text = error.what();
      EXPECT_NE(text.find("'pose'"), std::string::npos) << text;
      EXPECT_NE(text.find("element " + std::to_string(element) + " "), std::string::npos) << text;
    }
  };
  // Everything in one point, and for solids also a mirror image and a single element turned inside out.
  refuses(0 * elements.mesh.V, 0);
  if (elements.points.centre_edge) return;
  if (elements.mesh.element_points() <= elements.d) return;  // the edges of a rod have no inside
  RowMatrixXd mirrored = elements.mesh.V;
  mirrored.col(0) *= -1;
  refuses(mirrored, 0);
  const int last = static_cast<int>(elements.mesh.E.rows()) - 1;
  RowMatrixXd folded = elements.mesh.V;
  const int moved_vertex = elements.mesh.E(last, 0);
  Eigen::RowVectorXd opposite = Eigen::RowVectorXd::Zero(elements.d);
  for (int k = 1; k <= elements.d; ++k) opposite += folded.row(elements.mesh.E(last, k)) / elements.d;
  folded.row(moved_vertex) = opposite + 0.3 * (opposite - folded.row(moved_vertex));
  int first = last;
  const Vector sizes = element_sizes({folded, elements.mesh.E});
  for (int e = last; e >= 0; --e) {
    if (sizes[e] <= 0) first = e;
  }
  refuses(folded, first);
}

// With the weight of one example at 1, the rest shape has the measures of that pose.
TEST_P(Registration, ExamplesAreReached) {
  for (const char* name : {"examples", "strains"}) {
    const BodyCase tested{GetParam().model, rest_space_entry(name), GetParam().mesh};
    const BodyInput input = body_input(tested);
    const BodyModel body = make_body_model(input, {}, tested.model, tested.space);
    const ElasticModel model = build_model(tested.model, body.mesh, tested.space.layout, input.model);
    for (int k = 0; k < 3; ++k) {
      std::vector<Vector> S;
      body.rest->measures(body.elastic, Vector::Unit(3, k), S, nullptr);
      const Vector posed = stack(input.examples[static_cast<std::size_t>(k)].V, model.rest);
      for (std::size_t f = 0; f < S.size(); ++f) {
        Vector expected;
        model.families[f]->values(Side::rest, posed, expected);
        const bool angle = model.families[f]->kind() == MeasureKind::angle;
        EXPECT_LE(strain(S[f], expected, angle).norm(), 1e-13 * (1 + expected.norm())) << name << " " << k;
      }
    }
  }
}

// Fröhlich and Botsch interpolate lengths and angles, Martin et al. Green strains: linearly in the weights.
TEST_P(Registration, StrainsInterpolateTheMeasuresThemselves) {
  const BodyCase tested{GetParam().model, rest_space_entry("strains"), GetParam().mesh};
  const BodyModel body = make_body_model(body_input(tested), {}, tested.model, tested.space);
  const auto at = [&](const Vector& p, std::size_t f) {
    std::vector<Vector> S;
    body.rest->measures(body.elastic, p, S, nullptr);
    return body.elastic[f]->points_per_term() == 2 ? Vector(S[f].cwiseSqrt()) : S[f];
  };
  for (std::size_t f = 0; f < body.elastic.size(); ++f) {
    const Vector start = at(Vector::Zero(3), f);
    Vector mixed = start;
    const Eigen::Vector3d p(0.3, 0.2, 0.7);
    for (int k = 0; k < 3; ++k) mixed += p[k] * (at(Vector::Unit(3, k), f) - start);
    EXPECT_LE((at(p, f) - mixed).norm(), 1e-13 * (1 + mixed.norm()));
  }
}

TEST(Poses, OfAnotherMeshAreRefusedByName) {
  const SimMesh mesh = small_meshes(2, 3).front().mesh;
  const auto refuses = [&](const RowMatrixXd& V, const char* what) {
    try {
      check_pose({"crouch", "a", V}, mesh);
      ADD_FAILURE() << what;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::geometry);
      EXPECT_NE(std::string(error.what()).find("'crouch'"), std::string::npos) << error.what();
    }
  };
  refuses(mesh.V.topRows(5), "too few points");
  refuses(RowMatrixXd::Zero(mesh.V.rows(), 3), "another dimension");
  RowMatrixXd infinite = mesh.V;
  infinite(3, 1) = INFINITY;
  refuses(infinite, "infinite coordinates");
  EXPECT_NO_THROW(check_pose({"crouch", "a", mesh.V}, mesh));
}

TEST(Hull, CostsNothingInsideAndGrowsOutside) {
  const Hull hull{{{0, 2}, {1}}, 3};
  const auto energy = [&](const Vector& p) { return hull.energy(p); };
  EXPECT_EQ(energy(Eigen::Vector3d(0.3, 1, 0.7)), 0);
  EXPECT_EQ(energy(Eigen::Vector3d(0, 0, 0)), 0);
  EXPECT_DOUBLE_EQ(energy(Eigen::Vector3d(0.8, 0, 0.7)), 0.5 * 3 * 0.25);       // one group
  EXPECT_DOUBLE_EQ(energy(Eigen::Vector3d(0.8, 1, 0.2)), 0);                    // groups are alone
  EXPECT_DOUBLE_EQ(energy(Eigen::Vector3d(-0.5, 3, 0)), 0.5 * 3 * (0.25 + 4));  // negative, and above 1
  CounterRng rng(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Vector p = random_vector(3, 1.5, rng);
    Vector g = Vector::Zero(3);
    Matrix H = Matrix::Zero(3, 3);
    hull.add_gradient(p, g);
    hull.add_hessian(p, H);
    const auto value = [&](const Vector& r) { return Vector::Constant(1, energy(r)); };
    const auto gradient = [&](const Vector& r) {
      Vector sum = Vector::Zero(3);
      hull.add_gradient(r, sum);
      return sum;
    };
    EXPECT_LE((g.transpose() - differences(value, p, 1e-6)).norm(), 1e-8 * (1 + g.norm()));
    EXPECT_LE((H - differences(gradient, p, 1e-6)).norm(), 1e-8 * (1 + H.norm()));
  }
}

}  // namespace
}  // namespace vivify::sim
