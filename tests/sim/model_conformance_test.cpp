// Every model on each of its small meshes, with rest shapes whose elements hang together and with such that
// do not.
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>

#include "sim/control/rigid_motion.h"
#include "tests/sim/conformance.h"

namespace vivify::sim {

std::vector<ModelCase> model_cases(std::span<const ModelEntry> models) {
  std::vector<ModelCase> cases;
  for (const ModelEntry& model : models) {
    for (const NamedMesh& mesh : small_meshes(model.dimension, model.element_points))
      cases.push_back({model, mesh});
  }
  return cases;
}
std::string model_name(const ::testing::TestParamInfo<ModelCase>& tested) {
  return std::string(tested.param.model.name) + "_" + tested.param.mesh.name;
}

namespace {

INSTANTIATE_TEST_SUITE_P(Every, ModelConformance, ::testing::ValuesIn(model_cases(elastic_models())),
                         model_name);

// W, its derivatives by x, and E = ∂²W/∂x∂X.
struct Energy {
  Energy(const ModelCase& tested, RestLayout layout, const std::string& material = "")
      : model(build_model(tested.model, tested.mesh.mesh, layout,
                          settings(model_schema({&tested.model, 1}),
                                   "{type: " + std::string(tested.model.name) + material + "}"))),
        pattern(static_cast<int>(tested.mesh.mesh.V.rows()), tested.model.dimension) {
    for (const auto& family : model.families) family->reserve(pattern);
    pattern.finish();
    for (const auto& family : model.families) family->bind(pattern);
  }
  template <class Visit>
  void visit(const Vector& X, const Vector& x, const Visit& visit) const {
    for (const auto& family : model.families) {
      Vector s, S, g, G;
      family->gradients(Side::deformed, x, s, g);
      family->gradients(Side::rest, X, S, G);
      visit(*family, MeasureValues{family->coefficients(), s, S}, g, G);
    }
  }
  double value(const Vector& X, const Vector& x) const {
    double sum = 0;
    visit(X, x, [&](const MeasureFamily& family, const MeasureValues& at, const Vector&, const Vector&) {
      sum += family.law().energy(at);
    });
    return sum;
  }
  Vector gradient(const Vector& X, const Vector& x) const {
    Vector sum = Vector::Zero(x.size());
    visit(X, x, [&](const MeasureFamily& family, const MeasureValues& at, const Vector& g, const Vector&) {
      family.scatter(Side::deformed, g, family.law().stress(at), sum);
    });
    return sum;
  }
  Matrix stiffness(const Vector& X, const Vector& x) const {
    SymmetricMatrix D(pattern);
    visit(X, x, [&](const MeasureFamily& family, const MeasureValues& at, const Vector& g, const Vector&) {
      family.add_hessians(x, g, family.law().stiffness(at), family.law().stress(at), D);
    });
    return dense(D);
  }
  Matrix coupling(const Vector& X, const Vector& x) const {
    Matrix E = Matrix::Zero(x.size(), X.size());
    visit(X, x, [&](const MeasureFamily& family, const MeasureValues& at, const Vector& g, const Vector& G) {
      const Matrix J = family.gather(Side::deformed, g, Matrix::Identity(x.size(), x.size()));
      E += J.transpose() *
           family.law().couple(at, family.gather(Side::rest, G, Matrix::Identity(X.size(), X.size())));
    });
    return E;
  }

  ElasticModel model;
  SymmetricPattern pattern;
};

// A deformed shape and a rest shape in either layout.
struct State {
  State(const ModelCase& tested, const Energy& energy, std::uint64_t seed) : rng(seed) {
    const RowMatrixXd& V = tested.mesh.mesh.V;
    d = tested.model.dimension;
    reference = flat(V);
    x = reference + random_vector(V.size(), 0.02, rng);
    X0 = stack(V, energy.model.rest);
    X = X0 + random_vector(X0.size(), 0.01, rng);
  }
  Matrix rotation() { return random_rotation(d, rng); }
  Vector shift() { return random_vector(d, 1, rng); }

  CounterRng rng;
  int d;
  Vector reference, x, X0, X;
};

constexpr RestLayout kLayouts[] = {RestLayout::compatible, RestLayout::incompatible};

TEST_P(ModelConformance, ForceStiffnessAndRestCoupling) {
  for (const RestLayout layout : kLayouts) {
    const Energy energy(GetParam(), layout);
    State at(GetParam(), energy, 1);
    const auto value = [&](const Vector& x) { return Vector::Constant(1, energy.value(at.X, x)); };
    const auto gradient = [&](const Vector& x) { return energy.gradient(at.X, x); };
    const auto by_rest = [&](const Vector& X) { return energy.gradient(X, at.x); };
    const Vector g = gradient(at.x), l = random_vector(at.x.size(), 1, at.rng),
                 L = random_vector(at.X.size(), 1, at.rng);
    const Matrix D = energy.stiffness(at.X, at.x), E = energy.coupling(at.X, at.x);
    EXPECT_LE(relative(g.transpose(), differences(value, at.x, 1e-6)), 1e-6);
    EXPECT_LE(relative(D, differences(gradient, at.x, 1e-6)), 1e-6);
    EXPECT_LE(relative(E, differences(by_rest, at.X, 1e-6)), 1e-6);
    EXPECT_TRUE(converges(value, at.x, l, Vector::Constant(1, g.dot(l)), 3e-4));
    EXPECT_TRUE(converges(gradient, at.x, l, D * l, 3e-4));
    EXPECT_TRUE(converges(by_rest, at.X, L, E * L, 3e-4));
  }
}

TEST_P(ModelConformance, RigidMotionsOfEitherShapeChangeNothing) {
  for (const RestLayout layout : kLayouts) {
    const Energy energy(GetParam(), layout);
    State at(GetParam(), energy, 2);
    const double W = energy.value(at.X, at.x);
    const Vector g = energy.gradient(at.X, at.x), origin = Vector::Zero(at.d);
    const Matrix R = at.rotation();
    const Vector b = at.shift();
    EXPECT_GT(W, 1e-3);
    EXPECT_NEAR(energy.value(at.X, moved(R, b, at.x)), W, 1e-11 * W);
    EXPECT_LE(relative(energy.gradient(at.X, moved(R, b, at.x)), moved(R, origin, g)), 1e-11);
    EXPECT_NEAR(energy.value(moved(R, b, at.X), at.x), W, 1e-11 * W);
    EXPECT_LE(relative(energy.gradient(moved(R, b, at.X), at.x), g), 1e-11);
    Eigen::Vector3d force = Eigen::Vector3d::Zero(), torque = Eigen::Vector3d::Zero();
    for (Eigen::Index i = 0; i < at.x.size() / at.d; ++i) {
      const Eigen::Vector3d f = spatial_point(g, i, at.d);
      force += f;
      torque += spatial_point(at.x, i, at.d).cross(f);
    }
    EXPECT_LE(force.norm(), 1e-12 * g.norm());
    EXPECT_LE(torque.norm(), 1e-12 * g.norm());
  }
}

TEST_P(ModelConformance, NoForceAtRest) {
  for (const RestLayout layout : kLayouts) {
    const Energy energy(GetParam(), layout);
    State at(GetParam(), energy, 3);
    const double usual = energy.gradient(at.X, at.x).norm();
    EXPECT_LE(energy.gradient(at.X0, at.reference).norm(), 1e-14 * usual);
    EXPECT_LE(energy.gradient(at.X0, moved(at.rotation(), at.shift(), at.reference)).norm(), 1e-11 * usual);
    EXPECT_GT(energy.value(at.X0, at.x), 0);
  }
}

// Section 5.1: only the shape of every rest element counts, not where it lies.
TEST_P(ModelConformance, EveryRestElementMayBeMovedOnItsOwn) {
  const Energy energy(GetParam(), RestLayout::incompatible);
  State at(GetParam(), energy, 4);
  const std::vector<int>& begin = energy.model.rest.element_begin;
  ASSERT_EQ(begin.back(), energy.model.rest.size());
  Vector apart = at.X;
  for (std::size_t e = 0; e + 1 < begin.size(); ++e) {
    auto element = apart.segment(at.d * begin[e], at.d * (begin[e + 1] - begin[e]));
    element = moved(at.rotation(), at.shift(), element);
  }
  const double W = energy.value(at.X, at.x);
  EXPECT_NEAR(energy.value(apart, at.x), W, 1e-12 * W);
  EXPECT_LE(relative(energy.gradient(apart, at.x), energy.gradient(at.X, at.x)), 1e-12);
  EXPECT_LE(relative(energy.stiffness(apart, at.x), energy.stiffness(at.X, at.x)), 1e-12);
}

// Where the rest elements hang together, both layouts are the same energy.
TEST_P(ModelConformance, LayoutsAgreeOnCompatibleRestShapes) {
  const Energy shared(GetParam(), RestLayout::compatible), apart(GetParam(), RestLayout::incompatible);
  State at(GetParam(), shared, 5);
  ASSERT_EQ(at.X.size(), at.x.size());
  const RowMatrixXd V = at.X.reshaped<Eigen::RowMajor>(at.X.size() / at.d, at.d);
  const Vector X = stack(V, apart.model.rest);
  EXPECT_NEAR(apart.value(X, at.x), shared.value(at.X, at.x), 1e-13 * shared.value(at.X, at.x));
  EXPECT_LE(relative(apart.gradient(X, at.x), shared.gradient(at.X, at.x)), 1e-12);
  EXPECT_LE(relative(apart.stiffness(X, at.x), shared.stiffness(at.X, at.x)), 1e-12);
  EXPECT_EQ(shared.model.mass, apart.model.mass);
}

TEST_P(ModelConformance, RegionsChangeTheMaterialInsideOnly) {
  const SimMesh& mesh = GetParam().mesh.mesh;
  const std::string soft = "density: 7, stiffness: 500", half = "min: [0, 0, 0], max: [0.5, 1, 1]";
  const Eigen::RowVectorXd low = mesh.V.colwise().minCoeff(), high = mesh.V.colwise().maxCoeff();
  std::set<int> touched;
  std::set<int> soft_elements;
  for (Eigen::Index e = 0; e < mesh.E.rows(); ++e) {
    double x = 0;
    for (int k = 0; k < mesh.element_points(); ++k) x += mesh.V(mesh.E(e, k), 0) / mesh.element_points();
    if (x - low[0] > 0.5 * (high[0] - low[0])) continue;
    for (int k = 0; k < mesh.element_points(); ++k) touched.insert(mesh.E(e, k));
    soft_elements.insert(static_cast<int>(e));
  }
  ASSERT_FALSE(soft_elements.empty());
  ASSERT_LT(touched.size(), static_cast<std::size_t>(mesh.V.rows()));
  for (const RestLayout layout : kLayouts) {
    const Energy hard(GetParam(), layout),
        mixed(GetParam(), layout, ", regions: [{" + soft + ", " + half + "}]"),
        weak(GetParam(), layout, ", regions: [{" + soft + "}]"), same(GetParam(), layout, ", " + soft),
        other(GetParam(), layout,
              ", " + soft + ", regions: [{" + half + "}]");  // the defaults inside, soft outside
    State at(GetParam(), hard, 6);
    const auto gradient = [&](const Energy& energy) { return energy.gradient(at.X, at.x); };
    const Vector hard_force = gradient(hard), mixed_force = gradient(mixed), weak_force = gradient(weak);
    for (int v = 0; v < mesh.V.rows(); ++v) {
      const auto change = (hard_force - mixed_force).segment(at.d * v, at.d);
      if (touched.count(v) == 0) {
        EXPECT_LE(change.norm(), 1e-14 * hard_force.norm()) << "vertex " << v;
        EXPECT_EQ(mixed.model.mass[v], hard.model.mass[v]);
      } else {
        EXPECT_GT(change.norm(), 1e-6 * hard_force.norm()) << "vertex " << v;
        EXPECT_NE(mixed.model.mass[v], hard.model.mass[v]);
      }
    }
    // A region of everything is the material itself, and the halves add up.
    EXPECT_LE(relative(weak_force, gradient(same)), 1e-14);
    EXPECT_LE(relative(mixed_force + gradient(other), hard_force + weak_force), 1e-12);
    EXPECT_LE(relative(mixed.model.mass + other.model.mass, hard.model.mass + weak.model.mass), 1e-14);
  }
}

TEST_P(ModelConformance, MassIsDensityTimesSize) {
  const ModelCase& tested = GetParam();
  const Energy energy(tested, RestLayout::compatible, ", density: 7");
  EXPECT_NEAR(energy.model.mass.sum(), 7 * element_sizes(tested.mesh.mesh).sum(),
              1e-12 * energy.model.mass.sum());
  EXPECT_GT(energy.model.mass.minCoeff(), 0);
}

TEST_P(ModelConformance, RefusesDegenerateElementsByName) {
  ModelCase flat = GetParam();
  SimMesh& mesh = flat.mesh.mesh;
  const int e = static_cast<int>(mesh.E.rows()) - 1;
  if (mesh.element_points() < 4) {
    mesh.V.row(mesh.E(e, 0)) = mesh.V.row(mesh.E(e, 1));
  } else {
    std::swap(mesh.E(e, 0), mesh.E(e, 1));
  }
  const Vector sizes = element_sizes(mesh);
  const auto first =
      std::find_if(sizes.begin(), sizes.end(), [](double size) { return size <= 0; }) - sizes.begin();
  ASSERT_LE(first, e);
  try {
    const Energy energy(flat, RestLayout::compatible);
    FAIL() << "a degenerate element was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::geometry);
    EXPECT_NE(std::string(error.what()).find(' ' + std::to_string(first) + ' '), std::string::npos)
        << error.what();
  }
}

TEST_P(ModelConformance, RefusesMeshesOfAnotherKind) {
  const ModelCase& tested = GetParam();
  for (const auto& [dimension, points] : {std::pair{2, 2}, {2, 3}, {3, 3}, {3, 4}}) {
    if (dimension == tested.model.dimension && points == tested.model.element_points) continue;
    EXPECT_THROW(Energy({tested.model, small_meshes(dimension, points).front()}, RestLayout::compatible),
                 Error);
  }
}

}  // namespace
}  // namespace vivify::sim
