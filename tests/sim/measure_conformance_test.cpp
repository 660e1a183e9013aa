// Every measure as the family that the models use: its derivatives on either side, and its elastic law.
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <numbers>

#include "tests/sim/conformance.h"

namespace vivify::sim {

std::string measure_name(const ::testing::TestParamInfo<MeasureEntry>& tested) {
  return std::string(tested.param.name);
}

namespace {

INSTANTIATE_TEST_SUITE_P(Every, MeasureConformance, ::testing::ValuesIn(measures()), measure_name);

// A family of some terms on random stencils of their own, deformed and at rest.
struct Sample {
  Sample(const MeasureEntry& entry, std::uint64_t seed, int terms = 5, Kernels kernels = Kernels::packets)
      : rng(seed), family(entry.make(kernels)), pattern(terms * family->points_per_term(), entry.dimension) {
    const int points = family->points_per_term(), d = entry.dimension;
    x.resize(terms * points * d);
    X.resize(x.size());
    for (int t = 0; t < terms; ++t) {
      std::vector<int> deformed, rest;
      for (int k = 0; k < points; ++k) {
        deformed.push_back(points * t + k);
        rest.push_back(points * (terms - 1 - t) + k);
      }
      const Vector constants = random_vector(family->parameters(), 1, rng);
      family->add(deformed, rest, rng.uniform(0.5, 2),
                  {constants.data(), static_cast<std::size_t>(constants.size())});
      x.segment(d * points * t, d * points) = element(d, points);
      X.segment(d * points * t, d * points) = element(d, points);
    }
    family->reserve(pattern);
    pattern.finish();
    family->bind(pattern);
    w = random_vector(family->value_count(), 1, rng);
    l = random_vector(x.size(), 1, rng);
  }
  // Points of a good element, moved a little at random.
  Vector element(int d, int points) {
    Matrix element(3, 4);
    element.row(0) << 0, 1, 0.4, 0.6;
    element.row(1) << 0, 0, 0.9, -0.7;
    element.row(2) << 0, 0, 0, 0.6;
    return element.topLeftCorner(d, points).reshaped() + random_vector(d * points, 0.2, rng);
  }

  Vector values(Side side, const Vector& at) const {
    Vector s;
    family->values(side, at, s);
    return s;
  }
  Vector gradients(Side side, const Vector& at) const {
    Vector s, g;
    family->gradients(side, at, s, g);
    EXPECT_EQ(s, values(side, at));
    return g;
  }
  Matrix jacobian(Side side, const Vector& at) const {
    return family->gather(side, gradients(side, at), Matrix::Identity(at.size(), at.size()));
  }
  Vector weighted(Side side, const Vector& at) const {
    Vector sum = Vector::Zero(at.size());
    family->scatter(side, gradients(side, at), w, sum);
    return sum;
  }
  Matrix hessian(const Vector& at, const Vector& a, const Vector& b) const {
    SymmetricMatrix matrix(pattern);
    family->add_hessians(at, gradients(Side::deformed, at), a, b, matrix);
    return dense(matrix);
  }
  Matrix third(const Vector& a, const Vector& b, const Vector& db) const {
    SymmetricMatrix matrix(pattern);
    family->add_block_a(x, gradients(Side::deformed, x), a, b, db, l, matrix);
    return dense(matrix);
  }
  Matrix rest_hessian(const RowMatrixXd& L) const {
    Matrix C = Matrix::Zero(L.cols(), L.cols());
    family->add_rest_hessians(X, w, L, C);
    return C;
  }

  CounterRng rng;
  std::unique_ptr<MeasureFamily> family;
  SymmetricPattern pattern;
  Vector x, X, w, l;
};

constexpr double kEps = 1e-5, kCoarse = 2e-3;

TEST_P(MeasureConformance, GradientsOnEitherSide) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Sample s(GetParam(), seed);
    for (const Side side : {Side::deformed, Side::rest}) {
      const Vector& at = side == Side::rest ? s.X : s.x;
      const auto values = [&](const Vector& y) { return s.values(side, y); };
      const Matrix J = s.jacobian(side, at);
      EXPECT_LE(relative(J, differences(values, at, kEps)), 1e-8);
      EXPECT_TRUE(converges(values, at, s.l, J * s.l, kCoarse));
      EXPECT_LE(relative(s.weighted(side, at), J.transpose() * s.w), 1e-14) << "scatter against gather";
    }
  }
}

TEST_P(MeasureConformance, Hessians) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    Sample s(GetParam(), seed);
    const auto gradient = [&](const Vector& y) { return s.weighted(Side::deformed, y); };
    const Vector none = Vector::Zero(s.w.size());
    const Matrix H = s.hessian(s.x, none, s.w), J = s.jacobian(Side::deformed, s.x);
    EXPECT_LE(relative(H, differences(gradient, s.x, kEps)), 1e-8);
    EXPECT_TRUE(converges(gradient, s.x, s.l, H * s.l, kCoarse));
    Vector Hl, sum = Vector::Zero(s.x.size());
    s.family->hessian_products(s.x, s.l, Hl);
    s.family->scatter(Side::deformed, Hl, s.w, sum);
    EXPECT_LE(relative(sum, H * s.l), 1e-13);

    // With one weight per value, and with a block per term.
    const Vector a = random_vector(s.w.size(), 1, s.rng);
    EXPECT_LE(relative(s.hessian(s.x, a, none), J.transpose() * a.asDiagonal() * J), 1e-13);
    const int m = s.family->components();
    Matrix blocks = Matrix::Zero(s.w.size(), s.w.size());
    Vector flat_blocks(m * s.w.size());
    for (int t = 0; t < s.family->size(); ++t) {
      Matrix block = random_vector(m * m, 1, s.rng).reshaped(m, m);
      block = (block + block.transpose()).eval();
      blocks.block(m * t, m * t, m, m) = block;
      flat_blocks.segment(m * m * t, m * m) = block.reshaped();
    }
    EXPECT_LE(relative(s.hessian(s.x, flat_blocks, s.w), J.transpose() * blocks * J + H), 1e-13);
  }
}

TEST_P(MeasureConformance, HessiansOfTheRestStencils) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    Sample s(GetParam(), seed);
    const RowMatrixXd L = random_vector(3 * s.X.size(), 1, s.rng).reshaped(s.X.size(), 3);
    const auto gradient = [&](const Vector& q) -> Vector {
      return L.transpose() * s.weighted(Side::rest, s.X + L * q);
    };
    EXPECT_LE(relative(s.rest_hessian(L), differences(gradient, Vector::Zero(3), kEps)), 1e-8);
  }
}

TEST_P(MeasureConformance, ThirdDerivatives) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    Sample s(GetParam(), seed);
    const Vector a = random_vector(s.w.size(), 1, s.rng), db = random_vector(s.w.size(), 1, s.rng);
    const auto along = [&](const Vector& t) -> Vector {
      return s.hessian(s.x + t[0] * s.l, a, s.w + t[0] * db).reshaped();
    };
    const Vector exact = s.third(a, s.w, db).reshaped(), zero = Vector::Zero(1);
    EXPECT_LE(relative(exact, differences(along, zero, kEps)), 1e-8);
    EXPECT_TRUE(converges(along, zero, Vector::Ones(1), exact, kCoarse));
  }
}

// ∇³s[l] m = ∇³s[m] l.
TEST_P(MeasureConformance, ThirdDerivativesAreSymmetric) {
  Sample s(GetParam(), 8);
  const Vector none = Vector::Zero(s.w.size()), m = random_vector(s.x.size(), 1, s.rng);
  const Matrix along_l = s.third(none, s.w, none);
  const Vector both = along_l * m, l = s.l;
  s.l = m;
  EXPECT_LE((s.third(none, s.w, none) * l - both).norm(), 1e-13 * along_l.norm() * m.norm());
}

TEST_P(MeasureConformance, RigidMotionsChangeNothing) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    Sample s(GetParam(), seed);
    const int d = GetParam().dimension;
    const Matrix R = random_rotation(d, s.rng);
    const Vector y = moved(R, random_vector(d, 1, s.rng), s.x), origin = Vector::Zero(d);
    EXPECT_LE((s.values(Side::deformed, y) - s.values(Side::deformed, s.x)).lpNorm<Eigen::Infinity>(), 1e-13);
    EXPECT_LE(relative(s.weighted(Side::deformed, y), moved(R, origin, s.weighted(Side::deformed, s.x))),
              1e-12);
  }
}

// For any number of terms, also those that fill no packet.
TEST_P(MeasureConformance, PacketsAgreeWithScalars) {
  for (int terms = 1; terms <= 9; ++terms) {
    Sample p(GetParam(), 3, terms), s(GetParam(), 3, terms, Kernels::scalar);
    const Vector a = random_vector(p.w.size(), 1, p.rng), db = random_vector(p.w.size(), 1, p.rng);
    const RowMatrixXd L = random_vector(2 * p.X.size(), 1, p.rng).reshaped(p.X.size(), 2);
    const auto same = [&](const Matrix& packets, const Matrix& scalars) {
      return (packets - scalars).norm() <= 1e-14 * scalars.norm();
    };
    for (const Side side : {Side::deformed, Side::rest}) {
      const Vector& at = side == Side::rest ? s.X : s.x;
      EXPECT_TRUE(same(p.values(side, at), s.values(side, at))) << terms;
      EXPECT_TRUE(same(p.jacobian(side, at), s.jacobian(side, at))) << terms;
      EXPECT_TRUE(same(p.weighted(side, at), s.weighted(side, at))) << terms;
    }
    EXPECT_TRUE(same(p.hessian(p.x, a, p.w), s.hessian(p.x, a, p.w))) << terms;
    EXPECT_TRUE(same(p.third(a, p.w, db), s.third(a, p.w, db))) << terms;
    EXPECT_TRUE(same(p.rest_hessian(L), s.rest_hessian(L))) << terms;
  }
}

TEST_P(MeasureConformance, EqualTermsMergeExactly) {
  Sample s(GetParam(), 4);
  if (s.family->parameters() > 0) return;  // terms with constants are not merged
  const int points = s.family->points_per_term();
  const Vector c = s.family->coefficients();
  const std::vector<int> deformed = s.family->stencils(Side::deformed), rest = s.family->stencils(Side::rest);
  const auto energy = [&] {
    return s.family->law().energy(
        {s.family->coefficients(), s.values(Side::deformed, s.x), s.values(Side::rest, s.X)});
  };
  const double before = energy();
  for (int t = 0; t < 2; ++t) {
    const auto stencil = [&](const std::vector<int>& all) {
      return std::span(all).subspan(static_cast<std::size_t>(points * t), static_cast<std::size_t>(points));
    };
    s.family->add(stencil(deformed), stencil(rest), 2 * c[t]);
    s.family->add(stencil(deformed), stencil(deformed), 0);  // the same points, another rest stencil
  }
  const double with_more = energy();
  EXPECT_GT(with_more, before);
  s.family->merge_equal_terms();
  EXPECT_EQ(s.family->size(), 7);
  EXPECT_NEAR(energy(), with_more, 1e-14 * with_more);
}

// w(s, S) of the law that the family carries, at strains that no element is turned inside out by.
class LawSample {
 public:
  LawSample(const MeasureEntry& entry, std::uint64_t seed) : sample_(entry, seed) {
    CounterRng& rng = sample_.rng;
    const Eigen::Index n = sample_.w.size();
    s = random_vector(n, 0.2, rng);
    S = random_vector(n, 0.2, rng);
    ds = random_vector(n, 1, rng);
    dS = random_vector(n, 1, rng);
  }
  const Law& law() const { return sample_.family->law(); }
  MeasureValues at(const Vector& deformed, const Vector& rest) const {
    return {sample_.family->coefficients(), deformed, rest};
  }
  Vector energy(const Vector& deformed, const Vector& rest) const {
    return Vector::Constant(1, law().energy(at(deformed, rest)));
  }
  Matrix stiffness() const {
    const Vector stored = law().stiffness(at(s, S));
    if (law().diagonal()) return stored.asDiagonal();
    const int m = sample_.family->components();
    Matrix result = Matrix::Zero(s.size(), s.size());
    for (int t = 0; t < sample_.family->size(); ++t) {
      result.block(m * t, m * t, m, m) = stored.segment(m * m * t, m * m).reshaped(m, m);
    }
    return result;
  }
  Matrix unit() const { return Matrix::Identity(s.size(), s.size()); }

  Vector s, S, ds, dS;

 private:
  Sample sample_;
};

TEST_P(MeasureConformance, LawDerivatives) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const LawSample w(GetParam(), seed);
    const Law& law = w.law();
    const auto energy = [&](const Vector& s) { return w.energy(s, w.S); };
    const auto stress = [&](const Vector& s) { return law.stress(w.at(s, w.S)); };
    const auto stress_of_rest = [&](const Vector& S) { return law.stress(w.at(w.s, S)); };
    const Vector p = law.stress(w.at(w.s, w.S));
    EXPECT_LE(relative(p.transpose(), differences(energy, w.s, kEps)), 1e-8);
    const Matrix K = w.stiffness(), couple = law.couple(w.at(w.s, w.S), w.unit());
    EXPECT_LE(relative(K, differences(stress, w.s, kEps)), 1e-8);
    EXPECT_LE(relative(couple, differences(stress_of_rest, w.S, kEps)), 1e-8);
    EXPECT_TRUE(converges(stress_of_rest, w.S, w.dS, couple * w.dS, kCoarse));
    EXPECT_LE(relative(law.couple_transposed(w.at(w.s, w.S), w.unit()), couple.transpose()), 1e-14);

    const auto coupled = [&](const Vector& t) -> Vector {
      return Matrix(law.couple(w.at(w.s + t[0] * w.ds, w.S), w.unit())).reshaped();
    };
    const auto pulled_back = [&](const Vector& S) -> Vector {
      return law.couple_transposed(w.at(w.s, S), w.ds).col(0);
    };
    const Matrix rate = law.couple_rate(w.at(w.s, w.S), w.ds, w.unit());
    const Matrix curvature = law.rest_curvature(w.at(w.s, w.S), w.ds, w.unit());
    EXPECT_LE((rate.reshaped() - differences(coupled, Vector::Zero(1), kEps)).norm(),
              1e-8 * std::max(rate.norm(), couple.norm()));
    EXPECT_LE((curvature - differences(pulled_back, w.S, kEps)).norm(),
              1e-7 * std::max(curvature.norm(), couple.norm()));
    EXPECT_TRUE(converges(pulled_back, w.S, w.dS, curvature * w.dS, kCoarse));
    if (law.quadratic()) {
      EXPECT_EQ(rate.norm() + curvature.norm(), 0);
    } else {
      EXPECT_GT(rate.norm() * curvature.norm(), 0);
    }
  }
}

TEST_P(MeasureConformance, LawIsLeastWhereTheMeasuresAgree) {
  const LawSample w(GetParam(), 9);
  EXPECT_GT(w.energy(w.s, w.S)[0], 0);
  EXPECT_LE(w.energy(w.S, w.S)[0], 1e-14 * w.energy(w.s, w.S)[0]);
  EXPECT_LE(w.law().stress(w.at(w.S, w.S)).norm(), 1e-14 * w.law().stress(w.at(w.s, w.S)).norm());
}

// An angle that passes ±π has changed by a little, not by a turn.
TEST_P(MeasureConformance, AnglesPassTheirBranch) {
  const LawSample w(GetParam(), 2);
  const Vector one = Vector::Ones(w.s.size()), turn = 2 * std::numbers::pi * one;
  const double straight = w.energy(w.s + turn, w.S)[0];
  if (Sample(GetParam(), 2).family->kind() != MeasureKind::angle) {
    EXPECT_GT(std::abs(straight - w.energy(w.s, w.S)[0]), 1);
    return;
  }
  EXPECT_NEAR(straight, w.energy(w.s, w.S)[0], 1e-13);
  const double pi = std::numbers::pi;
  const Vector stress = w.law().stress(w.at((pi - 0.01) * one, (0.02 - pi) * one));
  EXPECT_LE(relative(stress, w.law().stress(w.at(-0.03 * one, 0 * one))), 1e-12);
}

}  // namespace
}  // namespace vivify::sim
