// Every measure against central differences, symmetry, invariance, scaling, known values, and in packs.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "sim/elastic/measures/area.h"
#include "sim/elastic/measures/dihedral_angle.h"
#include "sim/elastic/measures/edge_length.h"
#include "sim/elastic/measures/green_strain.h"
#include "sim/elastic/measures/turning_angle.h"
#include "sim/elastic/measures/volume.h"
#include "sim/elastic/packet.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

constexpr double kPi = std::numbers::pi;

// The functions of a measure behind run-time types, so that every test is compiled once. Columns are the
// lanes of a scalar of type T; rows are the entries of a stencil, gradient or Hessian, column by column.
struct Measured {
  template <class M, class T>
  static Measured of(std::string name) {
    Measured r{std::move(name), M::kDim,          M::kPoints,  M::kComponents,
               M::kParameters,  M::kMeasuresSize, M::kPeriodic};
    using Stencil = typename M::template Stencil<T>;
    using Values = typename M::template Values<T>;
    using Direction = typename M::template Direction<T>;
    using Parameters = typename M::template Parameters<T>;
    r.values = [](const Matrix& x, const Matrix& P) {
      return unpacked(M::template values<T>(packed<Stencil>(x), packed<Parameters>(P)));
    };
    r.gradients = [](const Matrix& x, const Matrix& P) {
      return unpacked(M::template gradients<T>(packed<Stencil>(x), packed<Parameters>(P)));
    };
    r.hessian = [](const Matrix& x, const Matrix& P, const Matrix& w) {
      return unpacked(M::template hessian<T>(packed<Stencil>(x), packed<Parameters>(P), packed<Values>(w)));
    };
    r.third = [](const Matrix& x, const Matrix& P, const Matrix& w, const Matrix& l) {
      return unpacked(M::template third<T>(packed<Stencil>(x), packed<Parameters>(P), packed<Values>(w),
                                           packed<Direction>(l)));
    };
    return r;
  }

  std::string name;
  int dim, points, components, parameters;
  bool measures_size, periodic;
  Matrix (*values)(const Matrix& x, const Matrix& P) = nullptr;
  Matrix (*gradients)(const Matrix& x, const Matrix& P) = nullptr;
  Matrix (*hessian)(const Matrix& x, const Matrix& P, const Matrix& w) = nullptr;
  Matrix (*third)(const Matrix& x, const Matrix& P, const Matrix& w, const Matrix& l) = nullptr;

  int size() const { return dim * points; }
  // The power of the size with which s grows.
  int degree() const { return periodic ? 0 : measures_size ? dim : 2; }

 private:
  template <class Packs>
  static Packs packed(const Matrix& columns) {
    Packs packs;
    for (Eigen::Index i = 0; i < columns.rows(); ++i) {
      for (int k = 0; k < kLanes<typename Packs::Scalar>; ++k) set_lane(packs.data()[i], k, columns(i, k));
    }
    return packs;
  }
  template <class Packs>
  static Matrix unpacked(const Packs& packs) {
    Matrix columns(packs.size(), kLanes<typename Packs::Scalar>);
    for (Eigen::Index i = 0; i < columns.rows(); ++i) {
      for (int k = 0; k < columns.cols(); ++k) columns(i, k) = lane(packs.data()[i], k);
    }
    return columns;
  }
};

template <class T>
std::vector<Measured> all_measures() {
  return {Measured::of<EdgeLength<2>, T>("edge_length_2d"),
          Measured::of<EdgeLength<3>, T>("edge_length_3d"),
          Measured::of<Area, T>("area"),
          Measured::of<Volume, T>("volume"),
          Measured::of<GreenStrain<2>, T>("green_strain_2d"),
          Measured::of<GreenStrain<3>, T>("green_strain_3d"),
          Measured::of<TurningAngle, T>("turning_angle"),
          Measured::of<DihedralAngle, T>("dihedral_angle")};
}

// Points of a good element, moved a little at random, one column per point.
Matrix random_element(int dim, int points, CounterRng& rng) {
  Matrix element(3, 4);
  element.row(0) << 0, 1, 0.4, 0.6;
  element.row(1) << 0, 0, 0.9, -0.7;
  element.row(2) << 0, 0, 0, 0.6;
  return element.topLeftCorner(dim, points) + random_vector(dim * points, 0.2, rng).reshaped(dim, points);
}

// The inverse of the edges from the first point, column by column.
Vector inverse_edges(const Matrix& element) {
  const Matrix edges = element.rightCols(element.cols() - 1).colwise() - element.col(0);
  return edges.inverse().reshaped();
}

// A measure at a random stencil with random weights, two random directions, and for strains the edges of
// another random element.
struct Sample {
  Sample(const Measured& measured, std::uint64_t seed) : measure(measured) {
    CounterRng rng(seed);
    x = random_element(measure.dim, measure.points, rng).reshaped();
    w = random_vector(measure.components, 1, rng);
    l = random_vector(measure.size(), 1, rng);
    m = random_vector(measure.size(), 1, rng);
    if (measure.parameters > 0) P = inverse_edges(random_element(measure.dim, measure.points, rng));
  }
  Vector values(const Vector& y) const { return measure.values(y, P); }
  Matrix gradients(const Vector& y) const {
    return measure.gradients(y, P).reshaped(measure.size(), measure.components);
  }
  Matrix hessian(const Vector& y) const {
    return measure.hessian(y, P, w).reshaped(measure.size(), measure.size());
  }
  Matrix third(const Vector& y) const {
    return measure.third(y, P, w, l).reshaped(measure.size(), measure.size());
  }
  Vector weighted_gradient(const Vector& y) const { return gradients(y) * w; }

  const Measured& measure;
  Vector x, w, l, m, P = Vector(0);
};

class MeasureTest : public ::testing::TestWithParam<Measured> {
 public:
  Sample sample(std::uint64_t seed) const { return Sample(GetParam(), seed); }
};

INSTANTIATE_TEST_SUITE_P(Every, MeasureTest, ::testing::ValuesIn(all_measures<double>()),
                         [](const auto& instance) { return instance.param.name; });

TEST_P(MeasureTest, DerivativesMatchDifferences) {
  double worst[3] = {0, 0, 0};
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Sample s = sample(seed);
    const auto record = [&worst](int order, double error) { worst[order] = std::max(worst[order], error); };
    record(0, relative(s.gradients(s.x).transpose(),
                       differences([&](const Vector& y) { return s.values(y); }, s.x, 1e-5)));
    const Matrix H = s.hessian(s.x), T = s.third(s.x);
    record(1, relative(H, differences([&](const Vector& y) { return s.weighted_gradient(y); }, s.x, 1e-5)));
    const auto along_l = [&](double t) { return s.hessian(s.x + t * s.l); };
    record(2, (T - (along_l(2e-5) - along_l(-2e-5)) / 4e-5).norm() / std::max(T.norm(), H.norm()));
  }
  EXPECT_LE(worst[0], 1e-8);
  EXPECT_LE(worst[1], 1e-8);
  EXPECT_LE(worst[2], 1e-7);
  for (int order = 0; order < 3; ++order) {
    RecordProperty("relative_error_of_derivative_" + std::to_string(order + 1),
                   ::testing::PrintToString(worst[order]));
  }
}

// Halving the step quarters the error of the central difference (summed over samples), unless nothing but
// rounding is left, as for polynomials of low degree.
TEST_P(MeasureTest, DifferencesConvergeInSecondOrder) {
  using Of = Matrix (*)(const Sample&, const Vector&);
  const auto check = [this](int order, bool exact, Of f, Of derivative) {
    const auto error = [&](double eps) {
      double sum = 0;
      for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const Sample s = sample(seed);
        const Vector step = eps * s.l;
        sum += ((f(s, s.x + step) - f(s, s.x - step)) / (2 * eps) - derivative(s, s.x)).norm();
      }
      return sum;
    };
    if (exact) {
      EXPECT_LE(error(0.02), 1e-11) << order;
    } else {
      EXPECT_GT(error(2e-3), 1e-8) << order;
      EXPECT_NEAR(error(4e-3) / error(2e-3), 4, 0.02) << order;
      EXPECT_NEAR(error(2e-3) / error(1e-3), 4, 0.02) << order;
    }
  };
  const bool angle = GetParam().periodic;
  const int degree = GetParam().degree();
  check(
      1, !angle && degree <= 2, [](const Sample& s, const Vector& y) -> Matrix { return s.values(y); },
      [](const Sample& s, const Vector& y) -> Matrix { return s.gradients(y).transpose() * s.l; });
  check(
      2, !angle && degree <= 3,
      [](const Sample& s, const Vector& y) -> Matrix { return s.weighted_gradient(y); },
      [](const Sample& s, const Vector& y) -> Matrix { return s.hessian(y) * s.l; });
  check(
      3, !angle, [](const Sample& s, const Vector& y) { return s.hessian(y); },
      [](const Sample& s, const Vector& y) { return s.third(y); });
}

TEST_P(MeasureTest, HigherDerivativesAreSymmetric) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Sample s = sample(seed);
    const Matrix H = s.hessian(s.x), T = s.third(s.x);
    EXPECT_LE((H - H.transpose()).norm(), 1e-14 * H.norm());
    EXPECT_LE((T - T.transpose()).norm(), 1e-14 * T.norm());
    const Vector along_both = T * s.m;
    std::swap(s.l, s.m);
    EXPECT_LE((s.third(s.x) * s.m - along_both).norm(), 1e-13 * T.norm());
  }
}

TEST_P(MeasureTest, RigidMotionsChangeNothing) {
  const int dim = GetParam().dim, size = GetParam().size();
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    CounterRng rng(1000 + seed);
    const Sample s = sample(seed);
    const Matrix R = dim == 3 ? Matrix(random_rotation(rng))
                              : Matrix(Eigen::Rotation2Dd(rng.uniform(0.5, 3)).toRotationMatrix());
    const Vector b = random_vector(dim, 10, rng);
    Vector moved(size);
    Matrix turn = Matrix::Zero(size, size);
    for (int i = 0; i < size; i += dim) {
      moved.segment(i, dim) = R * s.x.segment(i, dim) + b;
      turn.block(i, i, dim, dim) = R;
    }
    EXPECT_LE((s.values(moved) - s.values(s.x)).norm(), 1e-12);
    EXPECT_LE(relative(s.gradients(moved), turn * s.gradients(s.x)), 1e-12);
    EXPECT_LE(relative(s.hessian(moved), turn * s.hessian(s.x) * turn.transpose()), 1e-12);
  }
}

TEST_P(MeasureTest, ReflectionsFlipSizesAndAngles) {
  const Sample s = sample(5);
  Vector mirrored = s.x;
  for (int i = 0; i < mirrored.size(); i += GetParam().dim) mirrored[i] *= -1;
  const double sign = GetParam().measures_size || GetParam().periodic ? -1 : 1;
  EXPECT_GT(s.values(s.x).norm(), 0.01);
  EXPECT_LE((s.values(mirrored) - sign * s.values(s.x)).norm(), 1e-14);
}

TEST_P(MeasureTest, ScalesWithAPowerOfTheSize) {
  const auto power = [degree = GetParam().degree()](int order) { return std::pow(0.01, degree - order); };
  Vector constant = Vector::Zero(GetParam().components);  // what a strain of 0 lacks
  if (GetParam().parameters > 0) constant.head(GetParam().dim).setConstant(0.5);
  const Sample s = sample(6);
  const Vector scaled = 0.01 * s.x;
  EXPECT_LE(relative(s.values(scaled) + constant, power(0) * (s.values(s.x) + constant)), 1e-12);
  EXPECT_LE(relative(s.gradients(scaled), power(1) * s.gradients(s.x)), 1e-13);
  EXPECT_LE(relative(s.hessian(scaled), power(2) * s.hessian(s.x)), 1e-13);
  const Matrix T = s.third(s.x);
  EXPECT_LE((s.third(scaled) - power(3) * T).norm(), 1e-13 * power(3) * T.norm());
}

TEST(Measures, PacksGiveTheSameAsNumbers) {
  const std::vector<Measured> single = all_measures<double>(), packs = all_measures<Packet>();
  for (std::size_t i = 0; i < single.size(); ++i) {
    const Measured& measure = single[i];
    constexpr int kColumns = kLanes<Packet>;
    Matrix x(measure.size(), kColumns), l = x, w(measure.components, kColumns),
                                        P(measure.parameters, kColumns);
    for (int k = 0; k < kColumns; ++k) {
      const Sample s(measure, static_cast<std::uint64_t>(20 + k));
      x.col(k) = s.x, l.col(k) = s.l, w.col(k) = s.w, P.col(k) = s.P;
    }
    const Matrix results[] = {packs[i].values(x, P), packs[i].gradients(x, P), packs[i].hessian(x, P, w),
                              packs[i].third(x, P, w, l)};
    for (int k = 0; k < kColumns; ++k) {
      const Matrix xk = x.col(k), lk = l.col(k), wk = w.col(k), Pk = P.col(k);
      const Matrix expected[] = {measure.values(xk, Pk), measure.gradients(xk, Pk),
                                 measure.hessian(xk, Pk, wk), measure.third(xk, Pk, wk, lk)};
      for (int order = 0; order < 4; ++order) {
        EXPECT_LE((results[order].col(k) - expected[order]).norm(), 1e-14 * expected[order].norm())
            << measure.name << ", derivative " << order << ", lane " << k;
      }
    }
  }
}

double turning(double x2, double y2) {
  TurningAngle::Stencil<double> x;
  x << 0, 1, 1 + x2, 0, 0, y2;
  return TurningAngle::values<double>(x, {})[0];
}

// A hinge along the first axis whose second wing is turned out of the plane.
DihedralAngle::Stencil<double> hinge(double angle) {
  DihedralAngle::Stencil<double> x = DihedralAngle::Stencil<double>::Zero();
  x.col(1) << 2, 0, 0;
  x.col(2) << 0.5, 1.5, 0;
  x.col(3) << 1.2, -0.5 * std::cos(angle), -0.5 * std::sin(angle);
  return x;
}

TEST(Measures, LengthsAreasAndVolumesOfKnownElements) {
  EdgeLength<3>::Stencil<double> edge;
  edge << 1, 4, 1, 1, 1, 5;
  EXPECT_DOUBLE_EQ(EdgeLength<3>::values<double>(edge, {})[0], 25);
  EdgeLength<2>::Stencil<double> flat_edge;
  flat_edge << 1, 6, -2, 10;
  EXPECT_DOUBLE_EQ(EdgeLength<2>::values<double>(flat_edge, {})[0], 169);
  Area::Stencil<double> triangle;
  triangle << 1, 5, 1, 1, 1, 4;
  EXPECT_DOUBLE_EQ(Area::values<double>(triangle, {})[0], 6);
  triangle.col(1).swap(triangle.col(2));
  EXPECT_DOUBLE_EQ(Area::values<double>(triangle, {})[0], -6);
  Volume::Stencil<double> corner;
  corner << 0, 2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4;
  EXPECT_DOUBLE_EQ(Volume::values<double>(corner, {})[0], 4);
  Volume::Stencil<double> regular;  // edge √8 m, volume edge³ / √72
  regular << 1, -1, -1, 1, 1, -1, 1, -1, 1, 1, -1, -1;
  EXPECT_NEAR(Volume::values<double>(regular, {})[0], 8.0 / 3, 1e-14);
}

TEST(Measures, TurningAnglesOfKnownCorners) {
  EXPECT_EQ(turning(1, 0), 0);
  EXPECT_DOUBLE_EQ(turning(0, 3), kPi / 2);
  EXPECT_DOUBLE_EQ(turning(0, -3), -kPi / 2);
  EXPECT_DOUBLE_EQ(turning(-1, 1e-6), kPi - 1e-6);
  EXPECT_DOUBLE_EQ(turning(-1, -1e-6), 1e-6 - kPi);
  double sum = 0;  // once around a closed polygon
  const int corners = 7;
  for (int i = 0; i < corners; ++i) {
    TurningAngle::Stencil<double> x;
    for (int k = 0; k < 3; ++k) {
      const double angle = 2 * kPi * ((i + k) % corners) / corners;
      x.col(k) << 2 * std::cos(angle), std::sin(angle);
    }
    sum += TurningAngle::values<double>(x, {})[0];
  }
  EXPECT_NEAR(sum, 2 * kPi, 1e-14);
}

TEST(Measures, DihedralAnglesOfKnownHinges) {
  EXPECT_EQ(DihedralAngle::values<double>(hinge(0), {})[0], 0);
  for (const double angle : {0.3, kPi / 2, -kPi / 2, 3.0, kPi - 1e-6, 1e-6 - kPi, 1e-9, -1e-9}) {
    const auto x = hinge(angle);
    EXPECT_NEAR(DihedralAngle::values<double>(x, {})[0], angle, 4e-16 + 1e-15 * std::abs(angle)) << angle;
    // A point of a wing turns about the edge by its way over its height.
    const auto g = DihedralAngle::gradients<double>(x, {});
    EXPECT_NEAR(g.segment<3>(6).norm(), 1 / 1.5, 1e-14);
    EXPECT_NEAR(g.segment<3>(9).norm(), 1 / 0.5, 1e-14);
  }
  // Faces of the regular tetrahedron meet at arccos(1/3), so the normals turn by the rest of π. The normals
  // of this one point outwards, where every edge is a ridge.
  DihedralAngle::Stencil<double> regular;
  regular << 1, -1, -1, 1, 1, -1, 1, -1, 1, 1, -1, -1;
  regular.col(0).swap(regular.col(1));
  EXPECT_NEAR(DihedralAngle::values<double>(regular, {})[0], kPi - std::atan(std::sqrt(8.0)), 1e-15);
}

// Against the strain of the map itself, for an element that the map F x + b moves.
TEST(Measures, GreenStrainOfAffineMaps) {
  for (const Measured& measure : all_measures<double>()) {
    if (measure.parameters == 0) continue;
    const int dim = measure.dim;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      CounterRng rng(seed);
      const Matrix unit = Matrix::Identity(dim, dim);
      const Matrix F = unit + random_vector(dim * dim, 0.5, rng).reshaped(dim, dim);
      const Matrix reference = random_element(dim, dim + 1, rng);
      const Vector b = random_vector(dim, 1, rng);
      const Matrix x = (F * reference).colwise() + b;
      const Vector s = measure.values(x.reshaped(), inverse_edges(reference));
      const Matrix E = 0.5 * (F.transpose() * F - unit);
      EXPECT_NEAR(s.squaredNorm(), E.squaredNorm(), 1e-13 * E.squaredNorm());
      const double root = std::sqrt(2);
      Vector expected(measure.components);
      if (dim == 2) {
        expected << E(0, 0), E(1, 1), root * E(0, 1);
      } else {
        expected << E(0, 0), E(1, 1), E(2, 2), root * E(1, 2), root * E(0, 2), root * E(0, 1);
      }
      EXPECT_LE(relative(s, expected), 1e-13);
    }
  }
}

}  // namespace
}  // namespace vivify::sim
