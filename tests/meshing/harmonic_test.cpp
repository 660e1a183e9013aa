#include "meshing/harmonic.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "common/parallel.h"
#include "meshing/enclosure.h"
#include "tests/meshing/cage_shapes.h"

namespace vivify::meshing {
namespace {

TriangleMesh tetrahedron() {
  TriangleMesh mesh;
  mesh.V.resize(4, 3);
  mesh.V << 0, 0, 0, 2, 0.1, 0, 0.3, 1.5, 0.2, 0.4, 0.3, 1.8;
  mesh.F.resize(4, 3);
  mesh.F << 0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3;
  return mesh;
}

Points points_inside(const TriangleMesh& cage, int count, double clearance, std::uint64_t seed) {
  const Box box = bounding_box(cage.V);
  Points inside(count, 3);
  const Points candidates = shapes::random_points(40 * count, box.min, box.max, seed);
  int found = 0;
  for (Eigen::Index i = 0; i < candidates.rows() && found < count; ++i) {
    const Eigen::Vector3d p = candidates.row(i);
    if (winding_number(cage, p) > 0.5 && distance_to(cage, p) > clearance) inside.row(found++) = p;
  }
  EXPECT_EQ(found, count);
  return inside;
}

void expect_valid_weights(const Eigen::MatrixXd& weights, const TriangleMesh& cage, const Points& points) {
  EXPECT_GE(weights.minCoeff(), 0);
  EXPECT_LE(weights.maxCoeff(), 1);
  EXPECT_LE((weights.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-10);
  EXPECT_LE((weights * cage.V - points).rowwise().norm().maxCoeff(), 1e-10 * bounding_box(cage.V).diagonal());
}

// Hat function of `vertex` at a point q of the cage surface.
double hat_at(const TriangleMesh& cage, int vertex, const Eigen::Vector3d& q, Eigen::Index face) {
  for (int k = 0; k < 3; ++k) {
    if (cage.F(face, k) != vertex) continue;
    const Eigen::Vector3d a = cage.V.row(vertex), b = cage.V.row(cage.F(face, (k + 1) % 3)),
                          c = cage.V.row(cage.F(face, (k + 2) % 3));
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    return std::clamp((b - q).cross(c - q).dot(normal) / normal.squaredNorm(), 0.0, 1.0);
  }
  return 0;
}

// Walk on Spheres (Muller 1956): the mean of the hat functions where Brownian motion from x leaves the cage.
// Shares nothing with the solver but the distance to a triangle.
struct Estimate {
  Eigen::VectorXd mean, standard_error;
};
Estimate walk_on_spheres(const TriangleMesh& cage, const Eigen::Vector3d& x, int walks, std::uint64_t seed) {
  const double shell = 1e-4 * bounding_box(cage.V).diagonal();
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(cage.V.rows(), 2);
  for (int walk = 0; walk < walks; ++walk) {
    CounterRng rng(hash_words(seed, static_cast<std::uint64_t>(walk)));
    Eigen::Vector3d p = x, q = x;
    Eigen::Index face = 0;
    for (;;) {
      double nearest = 1e300;
      for (Eigen::Index f = 0; f < cage.F.rows(); ++f) {
        const Eigen::Vector3d c = closest_on_triangle(p, cage.V.row(cage.F(f, 0)), cage.V.row(cage.F(f, 1)),
                                                      cage.V.row(cage.F(f, 2)));
        if ((c - p).squaredNorm() < nearest) {
          nearest = (c - p).squaredNorm();
          q = c;
          face = f;
        }
      }
      const double radius = std::sqrt(nearest);
      if (radius < shell) break;
      const double z = rng.uniform(-1, 1), angle = rng.uniform(0, 2 * std::numbers::pi),
                   r = std::sqrt(1 - z * z);
      p += radius * Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), z);
    }
    for (int k = 0; k < 3; ++k) {
      const double hat = hat_at(cage, cage.F(face, k), q, face);
      sums(cage.F(face, k), 0) += hat;
      sums(cage.F(face, k), 1) += hat * hat;
    }
  }
  Estimate estimate;
  estimate.mean = sums.col(0) / walks;
  estimate.standard_error =
      ((sums.col(1) / walks - estimate.mean.cwiseAbs2()).cwiseMax(0) / (walks - 1)).cwiseSqrt();
  return estimate;
}

TEST(Harmonic, UnityLinearPrecisionAndRange) {
  for (const TriangleMesh& cage : {shapes::u_shape(), shapes::octahedron(), shapes::torus(1, 0.4, 9, 5)}) {
    const Points points = points_inside(cage, 100, 0.01, 7);
    HarmonicReport report;
    const Eigen::MatrixXd weights = harmonic_coordinates(cage, points, {}, &report);
    expect_valid_weights(weights, cage, points);
    EXPECT_GT(report.unknowns, 10000);
    EXPECT_LT(report.unknowns, 25000);
    EXPECT_GT(report.most_negative, -1e-3);
    EXPECT_LE(report.sum_error, 1e-10);
    EXPECT_LE(report.position_error, 1e-10);
  }
}

TEST(Harmonic, TetrahedronGivesBarycentricCoordinates) {
  const TriangleMesh cage = tetrahedron();
  const Points points = points_inside(cage, 30, 0.01, 8);
  const Eigen::MatrixXd weights = harmonic_coordinates(cage, points, {.unknowns = 2000});
  Eigen::Matrix4d corners;
  corners << cage.V.transpose(), Eigen::RowVector4d::Ones();
  for (Eigen::Index p = 0; p < points.rows(); ++p) {
    const Eigen::Vector4d barycentric = corners.inverse() * points.row(p).transpose().homogeneous();
    EXPECT_LE((weights.row(p).transpose() - barycentric).cwiseAbs().maxCoeff(), 1e-10);
  }
}

TEST(Harmonic, CentreOfTheOctahedron) {
  const Eigen::MatrixXd weights =
      harmonic_coordinates(shapes::octahedron(), Points::Zero(1, 3), {.unknowns = 4000});
  EXPECT_LE((weights.array() - 1.0 / 6).abs().maxCoeff(), 1e-3);
}

// Close to a cage vertex its weight is 1; close to a cage face only the face's corners have weight, by
// barycentric coordinates.
TEST(Harmonic, LagrangeProperty) {
  const TriangleMesh cage = shapes::u_shape();
  const double near = 1e-5;
  const Eigen::Index n = cage.V.rows(), m = cage.F.rows();
  Points points(n + m, 3);
  const Points normals = vertex_normals(cage.V, cage.F);
  for (Eigen::Index v = 0; v < n; ++v) points.row(v) = cage.V.row(v) - near * normals.row(v);
  const Eigen::RowVector3d split(0.2, 0.3, 0.5);
  for (Eigen::Index f = 0; f < m; ++f) {
    const Eigen::RowVector3d a = cage.V.row(cage.F(f, 0)), b = cage.V.row(cage.F(f, 1)),
                             c = cage.V.row(cage.F(f, 2));
    points.row(n + f) = split[0] * a + split[1] * b + split[2] * c - near * (b - a).cross(c - a).normalized();
  }
  const Eigen::MatrixXd weights =
      harmonic_coordinates(cage, points, {.unknowns = 2000, .both_diagonals = false});
  Eigen::MatrixXd wanted = Eigen::MatrixXd::Zero(n + m, n);
  wanted.topRows(n).setIdentity();
  for (Eigen::Index f = 0; f < m; ++f) {
    for (int k = 0; k < 3; ++k) wanted(n + f, cage.F(f, k)) = split[k];
  }
  EXPECT_LE((weights - wanted).cwiseAbs().maxCoeff(), 20 * near);
  expect_valid_weights(weights, cage, points);
}

TEST(Harmonic, WalkOnSpheresAgreesInANonConvexCage) {
  const TriangleMesh cage = shapes::u_shape();
  const Points points = points_inside(cage, 10, 0.05, 9);
  const Eigen::MatrixXd weights = harmonic_coordinates(cage, points, {.both_diagonals = false});
  constexpr int kWalks = 20000;
  std::vector<Estimate> oracle(10);
  parallel_for(10, [&](std::size_t p) {
    oracle[p] = walk_on_spheres(cage, points.row(static_cast<Eigen::Index>(p)), kWalks, 100 + p);
  });
  double worst = 0;
  for (std::size_t p = 0; p < 10; ++p) {
    EXPECT_NEAR(oracle[p].mean.sum(), 1, 1e-12);
    for (Eigen::Index c = 0; c < cage.V.rows(); ++c) {
      // The least standard error that the sample supports; a mean of a few rare hits says nothing about its
      // own.
      const double error = std::max(oracle[p].standard_error[c], 1.0 / kWalks);
      const double deviation = weights(static_cast<Eigen::Index>(p), c) - oracle[p].mean[c];
      EXPECT_LE(std::abs(deviation), 4 * error) << "point " << p << " cage vertex " << c;
      worst = std::max(worst, std::abs(deviation) / error);
    }
  }
  RecordProperty("largest_deviation_in_standard_errors", std::to_string(worst));
}

// Mirror images have mirrored weights in a box although its triangles are not symmetric, and the centre has
// equal ones.
TEST(Harmonic, FlatQuadrilateralsKeepTheSymmetryOfABox) {
  const TriangleMesh cage = shapes::box({-1, -1.5, -0.5}, {1, 1.5, 0.5});
  Points points(3, 3);
  points << 0, 0, 0, 0.5, 0.3, -0.2, -0.5, 0.3, -0.2;
  const Eigen::MatrixXd weights = harmonic_coordinates(cage, points);
  expect_valid_weights(weights, cage, points);
  const Eigen::MatrixXd skew = harmonic_coordinates(cage, points, {.both_diagonals = false});
  EXPECT_LE((weights.row(0).array() - 0.125).abs().maxCoeff(), 2e-3);
  EXPECT_GE((skew.row(0).array() - 0.125).abs().maxCoeff(), 0.02);
  for (int i = 0; i < 8; ++i) EXPECT_NEAR(weights(1, i), weights(2, i ^ 1), 2e-3);
}

// On a flat quadrilateral the weights are the mean over both diagonals.
TEST(Harmonic, FlatQuadrilateralsTakeTheMeanOfBothDiagonals) {
  const TriangleMesh cage = shapes::box({0, 0, 0}, {1, 1, 1});
  Points points(1, 3);
  points << 0.3, 0.2, 1e-5;  // corners 0, 1, 2, 3 of the side z = 0
  const Eigen::MatrixXd weights = harmonic_coordinates(cage, points, {.unknowns = 2000});
  Eigen::RowVectorXd wanted(8);
  wanted << (0.7 + 0.5) / 2, (0.1 + 0.3) / 2, (0 + 0.2) / 2, (0.2 + 0) / 2, 0, 0, 0, 0;
  EXPECT_LE((weights.row(0) - wanted).cwiseAbs().maxCoeff(), 1e-3);
}

// The tips of the arms of the U are 1 apart across the gap and about 5 through the inside.
TEST(Harmonic, InfluenceDoesNotJumpAcrossAGap) {
  const TriangleMesh cage = shapes::u_shape();
  Points tip(1, 3);
  tip << 0.6, 2.7, 0.5;
  const Eigen::MatrixXd weights = harmonic_coordinates(cage, tip, {.unknowns = 5000});
  double same_arm = 0, other_arm = 0;
  for (Eigen::Index c = 0; c < cage.V.rows(); ++c) {
    if (cage.V(c, 1) < 2.5) continue;
    (cage.V(c, 0) < 1.5 ? same_arm : other_arm) += weights(0, c);
  }
  EXPECT_GT(same_arm, 0.5);
  EXPECT_LT(other_arm, 1e-3);
}

TEST(Harmonic, MovesPointsAffinelyWithTheCage) {
  const TriangleMesh cage = shapes::u_shape();
  const Points points = points_inside(cage, 50, 0.05, 10);
  const Eigen::MatrixXd weights = harmonic_coordinates(cage, points, {.unknowns = 3000});
  Eigen::Matrix3d linear;
  linear << 0, -1.1, 0.2, 0.8, 0.1, 0, 0.3, 0, 1.2;
  EXPECT_LE((weights * (cage.V * linear) - points * linear).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(Harmonic, CoincidentPointsGetTheSameWeights) {
  const TriangleMesh cage = shapes::octahedron();
  Points points(3, 3);
  points << 0.1, 0.2, 0.1, -0.2, 0.1, 0.3, 0.1, 0.2, 0.1;
  const Eigen::MatrixXd weights = harmonic_coordinates(cage, points, {.unknowns = 1000});
  EXPECT_LE((weights.row(0) - weights.row(2)).cwiseAbs().maxCoeff(), 1e-12);
  expect_valid_weights(weights, cage, points);
}

TEST(Harmonic, MorePointsThanUnknownsAreInterpolated) {
  const TriangleMesh cage = shapes::octahedron();
  const Points points = points_inside(cage, 600, 0.02, 12);
  const Eigen::MatrixXd few = harmonic_coordinates(cage, points, {.unknowns = 500});
  const Eigen::MatrixXd many = harmonic_coordinates(cage, points, {.unknowns = 4000});
  expect_valid_weights(few, cage, points);
  EXPECT_LE((few - many).cwiseAbs().maxCoeff(), 0.05);
}

TEST(Harmonic, SameBitsForAnyNumberOfThreads) {
  const TriangleMesh cage = shapes::u_shape();
  const Points points = points_inside(cage, 40, 0.02, 13);
  set_thread_count(1);
  const Eigen::MatrixXd one = harmonic_coordinates(cage, points, {.unknowns = 3000});
  set_thread_count(2);
  const Eigen::MatrixXd two = harmonic_coordinates(cage, points, {.unknowns = 3000});
  set_thread_count(0);
  EXPECT_EQ(one, two);
}

TEST(Harmonic, ListsPointsOutsideOrOnTheCage) {
  const TriangleMesh cage = shapes::box({0, 0, 0}, {1, 1, 1});
  Points points(4, 3);
  points << 0.5, 0.5, 0.5, 1.2, 0.5, 0.5, 0.3, 0.3, 0.3, 1, 0.5, 0.5;
  try {
    harmonic_coordinates(cage, points);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::geometry);
    EXPECT_NE(std::string(error.what()).find("points 1 and 3"), std::string::npos) << error.what();
  }
}

// Reference: all subsets of zero weights, each solved by least squares with equalities.
Eigen::VectorXd nearest_weights_by_enumeration(const Eigen::VectorXd& w0, const Points& C,
                                               const Eigen::Vector3d& x) {
  const Eigen::Index n = C.rows();
  Eigen::VectorXd best;
  for (unsigned zero = 0; zero < (1U << n); ++zero) {
    std::vector<Eigen::Index> free;
    for (Eigen::Index c = 0; c < n; ++c) {
      if (!(zero >> c & 1U)) free.push_back(c);
    }
    if (free.size() < 4) continue;
    const Eigen::Index m = static_cast<Eigen::Index>(free.size());
    Eigen::MatrixXd kkt = Eigen::MatrixXd::Zero(m + 4, m + 4);
    kkt.topLeftCorner(m, m).setIdentity();
    for (Eigen::Index i = 0; i < m; ++i) {
      kkt.block<4, 1>(m, i) << 1, C.row(free[static_cast<std::size_t>(i)]).transpose();
    }
    kkt.topRightCorner(m, 4) = kkt.bottomLeftCorner(4, m).transpose();
    Eigen::VectorXd right(m + 4);
    for (Eigen::Index i = 0; i < m; ++i) right[i] = w0[free[static_cast<std::size_t>(i)]];
    right.tail<4>() << 1, x;
    const Eigen::VectorXd solution = kkt.fullPivLu().solve(right);
    if ((kkt * solution - right).norm() > 1e-9 || solution.head(m).minCoeff() < -1e-12) continue;
    Eigen::VectorXd w = Eigen::VectorXd::Zero(n);
    for (Eigen::Index i = 0; i < m; ++i) w[free[static_cast<std::size_t>(i)]] = solution[i];
    if (best.size() == 0 || (w - w0).norm() < (best - w0).norm()) best = w;
  }
  return best;
}

TEST(ProjectWeights, IsTheNearestPointOfTheFeasibleSet) {
  const Points C = shapes::box({0, 0, 0}, {1, 2, 1}).V;
  CounterRng rng(14);
  for (int trial = 0; trial < 40; ++trial) {
    const Eigen::Vector3d x(rng.uniform(0.02, 0.98), rng.uniform(0.02, 1.98), rng.uniform(0.02, 0.98));
    Eigen::VectorXd w0(8);
    for (int c = 0; c < 8; ++c) w0[c] = rng.uniform(-0.3, 0.6);
    const Eigen::VectorXd w = project_weights(w0, C, x);
    EXPECT_GE(w.minCoeff(), 0);
    EXPECT_LE(std::abs(w.sum() - 1), 1e-12);
    EXPECT_LE((C.transpose() * w - x).norm(), 1e-12);
    EXPECT_LE((w - nearest_weights_by_enumeration(w0, C, x)).cwiseAbs().maxCoeff(), 1e-9)
        << "trial " << trial;
  }
}

TEST(ProjectWeights, KeepsLinearPrecisionOfSlightlyNegativeWeights) {
  const TriangleMesh cage = shapes::u_shape();
  const Points points = points_inside(cage, 20, 0.02, 15);
  const Eigen::MatrixXd exact = harmonic_coordinates(cage, points, {.unknowns = 2000});
  for (Eigen::Index p = 0; p < points.rows(); ++p) {
    // A disturbance that keeps sums and positions, so that only the sign is wrong.
    Eigen::Matrix<double, 4, Eigen::Dynamic> A(4, cage.V.rows());
    A << Eigen::RowVectorXd::Ones(cage.V.rows()), cage.V.transpose();
    const Eigen::MatrixXd kernel = A.fullPivLu().kernel();
    Eigen::VectorXd w0 = exact.row(p).transpose() + 0.01 * kernel.col(0).normalized();
    if (w0.minCoeff() >= 0) w0 -= 0.02 * kernel.col(0).normalized();
    const Eigen::VectorXd w = project_weights(w0, cage.V, points.row(p));
    EXPECT_GE(w.minCoeff(), 0);
    EXPECT_LE((A * w - A * exact.row(p).transpose()).norm(), 1e-12);
    EXPECT_LE((w - w0).norm(),
              (exact.row(p).transpose() - w0).norm() + 1e-12);  // no feasible point is nearer
  }
}

TEST(ProjectWeights, PointOutsideTheHullIsAnError) {
  const Points C = shapes::box({0, 0, 0}, {1, 1, 1}).V;
  EXPECT_THROW(project_weights(Eigen::VectorXd::Constant(8, 0.125), C, {1.5, 0.5, 0.5}), Error);
}

}  // namespace
}  // namespace vivify::meshing
