// The references of the validation problems against each other and against remembered figures.
#include "bench/validation/references.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "bench/validation/convergence.h"
#include "bench/validation/problem.h"

namespace vivify::validation {
namespace {

TEST(References, ElasticaByTwoMethodsAndAsRemembered) {
  for (const double alpha : {0.1, 1.0, 4.0, 10.0}) {
    const TipMotion shot = elastica(alpha), exact = elastica_integrals(alpha);
    EXPECT_NEAR(shot.across, exact.across, 1e-9);
    EXPECT_NEAR(shot.back, exact.back, 1e-9);
  }
  EXPECT_NEAR(elastica(1).across, 0.302, 5e-4);
  EXPECT_NEAR(elastica(4).across, 0.670, 5e-4);
  EXPECT_NEAR(elastica(4).back, 0.329, 5e-4);
  EXPECT_NEAR(elastica(10).across, 0.811, 5e-4);
  // Small loads: α/3 across.
  EXPECT_NEAR(elastica(1e-3).across, 1e-3 / 3, 1e-9);
  // Sze et al. 2004, end shear: the same elastica at α = 4, but for its stretch.
  EXPECT_NEAR(10 * elastica(4).across, 6.698, 0.01);
  EXPECT_NEAR(10 * elastica(4).back, 3.286, 0.01);
}

TEST(References, SelfWeightBucklingByTwoMethodsAndAsRemembered) {
  EXPECT_NEAR(self_weight_buckling(), self_weight_buckling_bessel(), 1e-9);
  EXPECT_NEAR(self_weight_buckling(), 7.837, 5e-4);
}

TEST(References, FirstFrequencyOfACantileverAsRemembered) {
  EXPECT_NEAR(cantilever_frequency(), 3.516, 5e-4);
}

TEST(Convergence, FindsTheLimitAndTheOrder) {
  const auto v = [](double n) { return 0.98 - 3 * std::pow(n, -1.7); };
  const Convergence found = converge({1, 4, 6, 11}, {5, v(4), v(6), v(11)});
  EXPECT_NEAR(found.limit, 0.98, 1e-9);
  EXPECT_NEAR(found.order, 1.7, 1e-9);
}

TEST(Figure, HoldsWithinItsTolerance) {
  EXPECT_TRUE((Figure{"", 1.01, 1, 0.02}.holds()));
  EXPECT_FALSE((Figure{"", 1.03, 1, 0.02}.holds()));
  EXPECT_TRUE((Figure{"", 1e-9, 0, 1e-8}.holds()));
  EXPECT_FALSE((Figure{"", std::numeric_limits<double>::quiet_NaN(), 1, 1}.holds()));
}

}  // namespace
}  // namespace vivify::validation
