#include "meshing/planar_harmonic.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "common/error.h"
#include "common/parallel.h"
#include "common/rng.h"
#include "meshing/laplace.h"
#include "meshing/planar_mesh.h"
#include "meshing/polygons.h"
#include "meshing/refine_plane.h"
#include "tests/meshing/plane_shapes.h"

namespace vivify::meshing {
namespace {

Points2 points_inside(const Points2& cage, int count, double clearance, std::uint64_t seed) {
  const Eigen::AlignedBox2d box = box_of(cage);
  CounterRng rng(seed);
  Points2 inside(count, 2);
  for (int found = 0; found < count;) {
    const Eigen::Vector2d p(rng.uniform(box.min().x(), box.max().x()),
                            rng.uniform(box.min().y(), box.max().y()));
    if (winding_number({cage}, p) == 1 && distance_to({cage}, p) > clearance) inside.row(found++) = p;
  }
  return inside;
}

void expect_valid_weights(const Eigen::MatrixXd& weights, const Points2& cage, const Points2& points) {
  EXPECT_GE(weights.minCoeff(), 0);
  EXPECT_LE(weights.maxCoeff(), 1);
  EXPECT_LE((weights.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-10);
  EXPECT_LE((weights * cage - points).rowwise().norm().maxCoeff(), 1e-10 * box_of(cage).diagonal().norm());
}

TEST(PlanarHarmonic, UnityLinearPrecisionAndRange) {
  for (const Points2& cage : {shapes::u_polygon(), shapes::letter_i(), shapes::regular_polygon(7)}) {
    const Points2 points = points_inside(cage, 200, 0.01, 1);
    HarmonicReport report;
    const Eigen::MatrixXd weights = harmonic_coordinates(cage, points, {}, &report);
    expect_valid_weights(weights, cage, points);
    EXPECT_GT(report.unknowns, 12000);
    EXPECT_LT(report.unknowns, 20000);
    EXPECT_GT(report.most_negative, -1e-12);  // a Delaunay triangulation obeys the maximum principle
  }
}

// On a rectangle the boundary values are those of the bilinear functions, which are harmonic.
TEST(PlanarHarmonic, RectangleIsBilinear) {
  const Points2 cage = shapes::rectangle({-1, 2}, {2, 4});
  const Points2 points = points_inside(cage, 100, 0.02, 2);
  const Eigen::MatrixXd weights = harmonic_coordinates(cage, points);
  for (Eigen::Index p = 0; p < points.rows(); ++p) {
    const double u = (points(p, 0) + 1) / 3, v = (points(p, 1) - 2) / 2;
    const Eigen::RowVector4d exact((1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v);
    EXPECT_LE((weights.row(p) - exact).cwiseAbs().maxCoeff(), 2e-5);
  }
}

TEST(PlanarHarmonic, TriangleGivesBarycentricCoordinates) {
  const Points2 cage = shapes::polygon({{0, 0}, {2, 0.3}, {0.4, 1.7}});
  const Points2 points = points_inside(cage, 50, 0.01, 3);
  const Eigen::MatrixXd weights = harmonic_coordinates(cage, points, {.unknowns = 500});
  Eigen::Matrix3d corners;
  corners << cage.transpose(), Eigen::RowVector3d::Ones();
  for (Eigen::Index p = 0; p < points.rows(); ++p) {
    const Eigen::Vector3d exact = corners.inverse() * points.row(p).transpose().homogeneous();
    EXPECT_LE((weights.row(p).transpose() - exact).cwiseAbs().maxCoeff(), 1e-10);
  }
}

TEST(PlanarHarmonic, CentreOfARegularPolygon) {
  for (const int corners : {3, 5, 6, 12}) {
    const Eigen::MatrixXd weights =
        harmonic_coordinates(shapes::regular_polygon(corners), Points2::Zero(1, 2));
    EXPECT_LE((weights.array() - 1.0 / corners).abs().maxCoeff(), 2e-5) << corners;
  }
}

// Close to a cage vertex its weight is 1; close to a cage edge only its ends have weight, linearly.
TEST(PlanarHarmonic, LagrangeProperty) {
  const Points2 cage = shapes::u_polygon();
  const Eigen::Index n = cage.rows();
  const double near = 1e-5;
  Points2 points(2 * n, 2);
  Eigen::MatrixXd wanted = Eigen::MatrixXd::Zero(2 * n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::RowVector2d before = cage.row((i + n - 1) % n), here = cage.row(i),
                             after = cage.row((i + 1) % n);
    const Eigen::RowVector2d in = (here - before).normalized(), out = (after - here).normalized();
    const auto left = [](const Eigen::RowVector2d& d) { return Eigen::RowVector2d(-d.y(), d.x()); };
    points.row(i) = here + near * (left(in) + left(out));
    points.row(n + i) = 0.3 * here + 0.7 * after + near * left(out);
    wanted(i, i) = 1;
    wanted(n + i, i) = 0.3;
    wanted(n + i, (i + 1) % n) = 0.7;
  }
  const Eigen::MatrixXd weights = harmonic_coordinates(cage, points);
  expect_valid_weights(weights, cage, points);
  // At the reflex vertices the weight falls with the distance to the power 2/3.
  EXPECT_LE((weights - wanted).cwiseAbs().maxCoeff(), 3 * std::pow(near, 2.0 / 3));
}

// Walk on Spheres (Muller 1956): the mean of the hat functions where Brownian motion from x leaves the cage.
Eigen::RowVectorXd walk_on_spheres(const Points2& cage, const Eigen::Vector2d& x, int walks,
                                   std::uint64_t seed, Eigen::RowVectorXd& error) {
  const Eigen::Index n = cage.rows();
  Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(n), squares = sum;
  for (int walk = 0; walk < walks; ++walk) {
    CounterRng rng(hash_words(seed, static_cast<std::uint64_t>(walk)));
    Eigen::Vector2d p = x;
    for (;;) {
      double nearest = 1e300, place = 0;
      Eigen::Index edge = 0;
      for (Eigen::Index i = 0; i < n; ++i) {
        const Eigen::Vector2d a = cage.row(i), d = cage.row((i + 1) % n).transpose() - a;
        const double t = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
        const double distance = (a + t * d - p).norm();
        if (distance < nearest) {
          nearest = distance;
          place = t;
          edge = i;
        }
      }
      if (nearest < 1e-6) {
        const Eigen::Index other = (edge + 1) % n;
        sum[edge] += 1 - place;
        sum[other] += place;
        squares[edge] += (1 - place) * (1 - place);
        squares[other] += place * place;
        break;
      }
      const double angle = rng.uniform(0, 2 * std::numbers::pi);
      p += nearest * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    }
  }
  const Eigen::RowVectorXd mean = sum / walks;
  error = ((squares / walks - mean.cwiseAbs2()).cwiseMax(0) / walks).cwiseSqrt();
  return mean;
}

TEST(PlanarHarmonic, WalkOnSpheresAgreesInANonConvexCage) {
  const Points2 cage = shapes::u_polygon();
  const Points2 points = points_inside(cage, 6, 0.1, 4);
  const Eigen::MatrixXd weights = harmonic_coordinates(cage, points);
  constexpr int kWalks = 60000;
  parallel_for(6, [&](std::size_t i) {
    const Eigen::Index p = static_cast<Eigen::Index>(i);
    Eigen::RowVectorXd error;
    const Eigen::RowVectorXd mean = walk_on_spheres(cage, points.row(p), kWalks, 50 + i, error);
    for (Eigen::Index c = 0; c < cage.rows(); ++c) {
      EXPECT_LE(std::abs(weights(p, c) - mean[c]), 4 * std::max(error[c], 1.0 / kWalks) + 1e-4);
      EXPECT_LE(std::abs(weights(p, c) - mean[c]), 1e-2);
    }
  });
}

// Against the solution with seven times as many unknowns: at most 2e-3, and the error falls.
TEST(PlanarHarmonic, ConvergesRoundReflexVertices) {
  const Points2 cage = shapes::u_polygon();
  const Points2 points = points_inside(cage, 300, 0.02, 5);
  const Eigen::MatrixXd fine = harmonic_coordinates(cage, points, {.unknowns = 100000});
  const double coarse_error =
      (harmonic_coordinates(cage, points, {.unknowns = 1500}) - fine).cwiseAbs().maxCoeff();
  const double error = (harmonic_coordinates(cage, points) - fine).cwiseAbs().maxCoeff();
  EXPECT_LE(error, 2e-3);
  EXPECT_LE(error, 0.4 * coarse_error);
}

// x² − y² on an L: the error falls with the square of the edge length.
TEST(LaplaceProblem, SecondOrderInThePlane) {
  const Points2 loop = shapes::polygon({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}});
  Edges segments(6, 2);
  for (int i = 0; i < 6; ++i) segments.row(i) << i, (i + 1) % 6;
  const auto exact = [](const Eigen::RowVector2d& p) { return p.x() * p.x() - p.y() * p.y() + 0.3 * p.x(); };
  std::vector<double> errors;
  for (const double size : {0.2, 0.1, 0.05, 0.025}) {
    const auto mesh = refine_plane(loop, segments, {.longest_edge = size});
    std::vector<int> boundary;
    for (int v = 0; v < mesh->V.rows(); ++v) {
      if (distance_to({loop}, mesh->V.row(v).transpose()) < 1e-9) boundary.push_back(v);
    }
    const Eigen::VectorXi nodes = Eigen::Map<Eigen::VectorXi>(boundary.data(), std::ssize(boundary));
    Eigen::MatrixXd values(nodes.size(), 1);
    for (Eigen::Index i = 0; i < nodes.size(); ++i) values(i, 0) = exact(mesh->V.row(nodes[i]));
    const Eigen::MatrixXd solution = LaplaceProblem(mesh->V, mesh->F, nodes).solve(values);
    double squared = 0;
    for (Eigen::Index v = 0; v < mesh->V.rows(); ++v) {
      squared += std::pow(solution(v, 0) - exact(mesh->V.row(v)), 2);
    }
    errors.push_back(std::sqrt(squared / static_cast<double>(mesh->V.rows())));
  }
  EXPECT_GT(std::log2(errors.front() / errors.back()) / 3, 1.8);
}

TEST(PlanarHarmonic, InfluenceDoesNotJumpAcrossAGap) {
  const Points2 cage = shapes::u_polygon();
  const Eigen::MatrixXd weights = harmonic_coordinates(cage, shapes::polygon({{0.6, 2.7}}));
  EXPECT_LT(weights(0, 2) + weights(0, 3), 1e-3);  // the tip of the other arm
  EXPECT_GT(weights(0, 6) + weights(0, 7), 0.5);
}

TEST(PlanarHarmonic, CoincidentPointsAndMorePointsThanUnknowns) {
  const Points2 cage = shapes::u_polygon();
  Points2 points = points_inside(cage, 600, 0.02, 6);
  points.row(1) = points.row(0);
  const Eigen::MatrixXd few = harmonic_coordinates(cage, points, {.unknowns = 500});
  const Eigen::MatrixXd many = harmonic_coordinates(cage, points, {.unknowns = 20000});
  expect_valid_weights(few, cage, points);
  expect_valid_weights(many, cage, points);
  EXPECT_EQ(many.row(0), many.row(1));
  EXPECT_LE((few - many).cwiseAbs().maxCoeff(), 0.05);
}

TEST(PlanarHarmonic, SameBitsForAnyNumberOfThreads) {
  const Points2 cage = shapes::u_polygon();
  const Points2 points = points_inside(cage, 40, 0.02, 7);
  set_thread_count(1);
  const Eigen::MatrixXd one = harmonic_coordinates(cage, points, {.unknowns = 3000});
  set_thread_count(2);
  const Eigen::MatrixXd two = harmonic_coordinates(cage, points, {.unknowns = 3000});
  set_thread_count(0);
  EXPECT_EQ(one, two);
}

TEST(PlanarHarmonic, ListsPointsOutsideOrOnTheCage) {
  try {
    harmonic_coordinates(shapes::rectangle({0, 0}, {1, 1}),
                         shapes::polygon({{0.5, 0.5}, {1.2, 0.5}, {0.3, 0.3}, {1, 0.5}}));
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::geometry);
    EXPECT_NE(std::string(error.what()).find("points 1 and 3"), std::string::npos) << error.what();
  }
}

TEST(ProjectWeights, IsFeasibleAndNearestInThePlane) {
  const Points2 C = shapes::regular_polygon(6);
  CounterRng rng(8);
  for (int trial = 0; trial < 40; ++trial) {
    const Eigen::Vector2d x(rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5));
    Eigen::VectorXd w0(6);
    for (int c = 0; c < 6; ++c) w0[c] = rng.uniform(-0.3, 0.6);
    const Eigen::VectorXd w = project_weights(w0, C, x);
    EXPECT_GE(w.minCoeff(), 0);
    EXPECT_LE(std::abs(w.sum() - 1), 1e-12);
    EXPECT_LE((C.transpose() * w - x).norm(), 1e-12);
    // Optimality: w0 − w makes an obtuse angle with the way to any other feasible weights.
    Eigen::VectorXd other = Eigen::VectorXd::Zero(6);
    for (int k = 0; k < 20; ++k) {
      for (int c = 0; c < 6; ++c) other[c] = rng.uniform(0, 1);
      other = project_weights(other, C, x);
      EXPECT_LE((w0 - w).dot(other - w), 1e-10);
    }
  }
  EXPECT_THROW(project_weights(Eigen::VectorXd::Constant(6, 1.0 / 6), C, {1.5, 0}), Error);
}

}  // namespace
}  // namespace vivify::meshing
