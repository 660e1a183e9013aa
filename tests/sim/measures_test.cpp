// Measures of known stencils, and how they scale and reflect. What all measures share is in
// measure_conformance_test.cpp.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <vector>

#include "sim/elastic/measures/area.h"
#include "sim/elastic/measures/dihedral_angle.h"
#include "sim/elastic/measures/edge_length.h"
#include "sim/elastic/measures/green_strain.h"
#include "sim/elastic/measures/turning_angle.h"
#include "sim/elastic/measures/volume.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

constexpr double kPi = std::numbers::pi;

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

// A family of a single term; strains are measured from `reference`.
struct OneTerm {
  OneTerm(const MeasureEntry& entry, const Matrix& reference) : family(entry.make(Kernels::scalar)) {
    std::vector<int> points;
    for (int k = 0; k < family->points_per_term(); ++k) points.push_back(k);
    const Vector constants = family->parameters() > 0 ? inverse_edges(reference) : Vector(0);
    family->add(points, points, 1, {constants.data(), static_cast<std::size_t>(constants.size())});
  }
  OneTerm(const MeasureEntry& entry, CounterRng& rng)
      : OneTerm(entry, random_element(entry.dimension, entry.make(Kernels::scalar)->points_per_term(), rng)) {
  }
  Vector values(const Vector& x) const {
    Vector s;
    family->values(Side::deformed, x, s);
    return s;
  }
  Matrix jacobian(const Vector& x) const {
    Vector s, g;
    family->gradients(Side::deformed, x, s, g);
    return family->gather(Side::deformed, g, Matrix::Identity(x.size(), x.size()));
  }
  bool strains() const { return family->parameters() > 0; }
  std::unique_ptr<MeasureFamily> family;
};

TEST(Measures, ReflectionsFlipSizesAndAngles) {
  for (const MeasureEntry& entry : measures()) {
    CounterRng rng(5);
    const OneTerm term(entry, rng);
    Vector x = random_element(entry.dimension, term.family->points_per_term(), rng).reshaped(), mirrored = x;
    for (int i = 0; i < mirrored.size(); i += entry.dimension) mirrored[i] *= -1;
    const double sign = term.family->kind() == MeasureKind::stretch ? 1 : -1;
    EXPECT_GT(term.values(x).norm(), 0.01) << entry.name;
    EXPECT_LE((term.values(mirrored) - sign * term.values(x)).norm(), 1e-14) << entry.name;
  }
}

// Lengths are squared, strains too but for a constant; areas and volumes have the power of the dimension.
TEST(Measures, ScaleWithAPowerOfTheSize) {
  for (const MeasureEntry& entry : measures()) {
    CounterRng rng(6);
    const OneTerm term(entry, rng);
    const MeasureKind kind = term.family->kind();
    const int degree = kind == MeasureKind::angle ? 0 : kind == MeasureKind::size ? entry.dimension : 2;
    Vector constant = Vector::Zero(term.family->components());
    if (term.strains()) constant.head(entry.dimension).setConstant(0.5);
    const Vector x = random_element(entry.dimension, term.family->points_per_term(), rng).reshaped();
    EXPECT_LE(
        relative(term.values(0.01 * x) + constant, std::pow(0.01, degree) * (term.values(x) + constant)),
        1e-12)
        << entry.name;
    EXPECT_LE(relative(term.jacobian(0.01 * x), std::pow(0.01, degree - 1) * term.jacobian(x)), 1e-13)
        << entry.name;
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
  for (const MeasureEntry& entry : measures()) {
    if (entry.make(Kernels::scalar)->parameters() == 0) continue;
    const int dim = entry.dimension;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      CounterRng rng(seed);
      const Matrix unit = Matrix::Identity(dim, dim);
      const Matrix F = unit + random_vector(dim * dim, 0.5, rng).reshaped(dim, dim);
      const Matrix reference = random_element(dim, dim + 1, rng);
      const Vector b = random_vector(dim, 1, rng);
      const Matrix x = (F * reference).colwise() + b;
      const Vector s = OneTerm(entry, reference).values(x.reshaped());
      const Matrix E = 0.5 * (F.transpose() * F - unit);
      EXPECT_NEAR(s.squaredNorm(), E.squaredNorm(), 1e-13 * E.squaredNorm());
      const double root = std::sqrt(2);
      Vector expected(s.size());
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
