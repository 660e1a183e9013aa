// Every measure against central differences: value, gradient, Hessian, third derivative.
#include <gtest/gtest.h>

#include "sim/elastic/measures/edge_length.h"
#include "sim/elastic/measures/volume.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

template <class Measure>
class MeasureTest : public ::testing::Test {
 public:
  static constexpr int kDim = Measure::kSize / Measure::kPoints;
  static typename Measure::Stencil stencil(const Vector& x) {
    return Eigen::Map<const typename Measure::Stencil>(x.data());
  }
  static Vector value(const Vector& x) { return Vector::Constant(1, Measure::value(stencil(x))); }
  static Vector gradient(const Vector& x) { return Measure::gradient(stencil(x)); }
  static Matrix hessian(const Vector& x) { return Measure::hessian(stencil(x)); }
};

using Measures = ::testing::Types<EdgeLength<2>, EdgeLength<3>, Volume>;
TYPED_TEST_SUITE(MeasureTest, Measures);

TYPED_TEST(MeasureTest, DerivativesMatchDifferences) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    CounterRng rng(seed);
    const Vector x = random_vector(TypeParam::kSize, 1, rng), l = random_vector(TypeParam::kSize, 1, rng);
    EXPECT_LE(relative(this->gradient(x).transpose(), differences(this->value, x, 1e-5)), 1e-8);
    const Matrix H = this->hessian(x);
    EXPECT_LE(relative(H, differences(this->gradient, x, 1e-4)), 1e-9);
    const auto along_l = [&](const Vector& y) { return Vector(this->hessian(y) * l); };
    // d/dε H(x + ε l) = third(l); as H l is differentiated here, symmetry of the third derivative is tested
    // too.
    EXPECT_LE((Matrix(TypeParam::third(this->stencil(x), l)) - differences(along_l, x, 1e-3)).norm(), 1e-10);
    EXPECT_LE((H - H.transpose()).norm(), 1e-15);
  }
}

// The measures are polynomials: central differences of a quadratic are exact, those of the cubic volume are
// too along coordinates; along a general direction their error is ε² times the value at the direction.
TYPED_TEST(MeasureTest, DifferencesConvergeInSecondOrderOrAreExact) {
  CounterRng rng(7);
  const Vector x = random_vector(TypeParam::kSize, 1, rng), d = random_vector(TypeParam::kSize, 1, rng);
  const auto error = [&](double eps) {
    const double difference = (this->value(x + eps * d) - this->value(x - eps * d))[0] / (2 * eps);
    return std::abs(difference - this->gradient(x).dot(d));
  };
  if (TypeParam::kMeasuresSize) {
    EXPECT_NEAR(error(0.2) / error(0.1), 4, 1e-6);
    EXPECT_NEAR(error(0.1), 0.01 * std::abs(this->value(d)[0]), 1e-12);
  } else {
    EXPECT_LE(error(0.2), 1e-13);
    EXPECT_LE(error(0.1), 1e-13);
  }
}

TYPED_TEST(MeasureTest, RigidMotionsChangeNothingAndReflectionsFlipSizes) {
  if constexpr (TypeParam::kSize / TypeParam::kPoints == 3) {
    CounterRng rng(3);
    const Vector x = random_vector(TypeParam::kSize, 1, rng);
    const double s = this->value(x)[0];
    const Vector moved = rigid(random_rotation(rng), random_vector(3, 1, rng), x);
    EXPECT_NEAR(this->value(moved)[0], s, 1e-14);
    const double mirrored = this->value(-x)[0];
    EXPECT_NEAR(mirrored, TypeParam::kMeasuresSize ? -s : s, 1e-15);
  }
}

TEST(Measures, KnownValues) {
  EdgeLength<3>::Stencil edge;
  edge << 1, 4, 1, 1, 1, 5;
  EXPECT_DOUBLE_EQ(EdgeLength<3>::value(edge), 25);
  Volume::Stencil corner;
  corner << 0, 2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4;
  EXPECT_DOUBLE_EQ(Volume::value(corner), 4);
}

}  // namespace
}  // namespace vivify::sim
