// Nearest points, signs and normals against closed forms and brute force.
#include "sim/contact/collider.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "common/error.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

TriangleMesh surface_of(const TetMesh& mesh) { return {mesh.V, boundary_faces(mesh), {}, {}, {}}; }

// Signed distance to the box [low, high].
double box_distance(const Eigen::Vector3d& p, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  const Eigen::Vector3d beyond = (low - p).cwiseMax(p - high);
  return beyond.maxCoeff() < 0 ? beyond.maxCoeff() : beyond.cwiseMax(0).norm();
}

TEST(Collider, SignedDistanceOfABoxEverywhere) {
  const Eigen::Vector3d low(-0.4, 0, -0.4), high(0.4, 1, 0.4);
  const Collider box("box", surface_of(standing_box()), 1);
  CounterRng rng(1);
  int inside = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    Eigen::Vector3d p;
    for (int axis = 0; axis < 3; ++axis) p[axis] = rng.uniform(low[axis] - 0.5, high[axis] + 0.5);
    // A third of the points lie above faces, edges and corners in special position.
    if (trial % 3 == 0) p = (p * 5).array().round() / 5;
    const double expected = box_distance(p, low, high);
    const SurfacePoint nearest = box.nearest(p);
    EXPECT_NEAR(nearest.distance, expected, 1e-12) << p.transpose();
    EXPECT_NEAR((nearest.position - p).norm(), std::abs(expected), 1e-12);
    EXPECT_NEAR(nearest.normal.norm(), 1, 1e-12);
    EXPECT_NEAR(nearest.normal.dot(p - nearest.position), expected, 1e-12);
    if (std::abs(expected) > 1e-9) inside += expected < 0;
  }
  EXPECT_GT(inside, 100);
}

TEST(Collider, NormalIsTheGradientOfTheDistance) {
  const Collider box("box", surface_of(standing_box()), 1);
  CounterRng rng(2);
  int tested = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Vector p = random_vector(3, 1.2, rng);
    const SurfacePoint nearest = box.nearest(p);
    if (nearest.distance < 1e-3) continue;  // inside, the medial axis is near
    const auto distance = [&](const Vector& y) { return Vector::Constant(1, box.nearest(y).distance); };
    EXPECT_LE((nearest.normal.transpose() - differences(distance, p, 1e-6)).norm(), 1e-4);
    ++tested;
  }
  EXPECT_GT(tested, 100);
}

// Nearest point of a triangle by sampling its plane, edges and corners one after the other.
Eigen::Vector3d nearest_by_parts(const Eigen::Vector3d& p, const std::array<Eigen::Vector3d, 3>& t) {
  const Eigen::Vector3d n = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
  const Eigen::Vector3d projected = p - n * n.dot(p - t[0]);
  bool within = true;
  for (int k = 0; k < 3; ++k) within = within && (t[(k + 1) % 3] - t[k]).cross(projected - t[k]).dot(n) >= 0;
  if (within) return projected;
  Eigen::Vector3d best = t[0];
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d edge = t[(k + 1) % 3] - t[k];
    const Eigen::Vector3d on_edge =
        t[k] + edge * std::clamp(edge.dot(p - t[k]) / edge.squaredNorm(), 0.0, 1.0);
    if ((on_edge - p).norm() < (best - p).norm()) best = on_edge;
  }
  return best;
}

TEST(Collider, NearestPointOfARandomSurfaceIsThatOfBruteForce) {
  CounterRng rng(3);
  TriangleMesh soup;
  soup.V = rows(random_vector(3 * 180, 1, rng));
  soup.F.resize(60, 3);
  for (int f = 0; f < 60; ++f) soup.F.row(f) << 3 * f, 3 * f + 1, 3 * f + 2;
  const Collider collider("soup", soup, 1);
  for (int trial = 0; trial < 1000; ++trial) {
    const Eigen::Vector3d p = random_vector(3, 2, rng);
    double best = INFINITY;
    for (int f = 0; f < 60; ++f) {
      const auto corner = [&](int k) -> Eigen::Vector3d { return soup.V.row(3 * f + k).transpose(); };
      best = std::min(best, (nearest_by_parts(p, {corner(0), corner(1), corner(2)}) - p).norm());
    }
    const SurfacePoint nearest = collider.nearest(p);
    EXPECT_NEAR(std::abs(nearest.distance), best, 1e-12);
    EXPECT_NEAR((nearest.position - p).norm(), best, 1e-12);
  }
}

// An inner edge of a fold is nearest from one side only; the pseudo-normals give the sign there.
TEST(Collider, SignsAtNonConvexEdgesAndCorners) {
  // A box with a notch: the boundary of three of four cells of an L.
  const TetMesh whole = box_mesh({2, 2, 1}, {2, 2, 1}, {-1, -1, -0.5});
  TetMesh part{whole.V, Tetrahedra(15, 4)};
  int kept = 0;
  for (Eigen::Index t = 0; t < whole.T.rows(); ++t) {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (int k = 0; k < 4; ++k) centre += whole.V.row(whole.T(t, k)).transpose() / 4;
    if (centre.x() > 0 && centre.y() > 0) continue;
    part.T.row(kept++) = whole.T.row(t);
  }
  ASSERT_EQ(kept, 15);
  const Collider collider("L", surface_of(part), 1);
  CounterRng rng(4);
  for (int trial = 0; trial < 2000; ++trial) {
    const Eigen::Vector3d p(rng.uniform(-1.3, 1.3), rng.uniform(-1.3, 1.3), rng.uniform(-0.8, 0.8));
    const bool inside =
        p.cwiseAbs().x() < 1 && p.cwiseAbs().y() < 1 && std::abs(p.z()) < 0.5 && !(p.x() > 0 && p.y() > 0);
    EXPECT_EQ(collider.nearest(p).distance < 0, inside) << p.transpose();
  }
}

TEST(Collider, ExactlyOnTheSurfaceTheNormalIsStillRight) {
  const Collider box("box", surface_of(standing_box()), 1);
  const SurfacePoint top = box.nearest({0.1, 1, 0.13});
  EXPECT_EQ(top.distance, 0);
  EXPECT_LE((top.normal - Eigen::Vector3d::UnitY()).norm(), 1e-12);
  const SurfacePoint edge = box.nearest({0.4, 1, 0.1});
  EXPECT_NEAR(edge.distance, 0, 1e-15);
  EXPECT_GT(edge.normal.x() + edge.normal.y(), 0.9);
}

TEST(Collider, AnOpenSurfaceHasNoInsideBeyondItsRim) {
  TriangleMesh quad;
  quad.V.resize(4, 3);
  quad.V << -1, 0, -1, -1, 0, 1, 1, 0, 1, 1, 0, -1;
  quad.F.resize(2, 3);
  quad.F << 0, 1, 2, 0, 2, 3;
  const Collider table("table", quad, 1);
  EXPECT_NEAR(table.nearest({0.3, -0.2, 0.1}).distance, -0.2, 1e-12);  // under the table, not beside it
  EXPECT_NEAR(table.nearest({1.3, -0.4, 0}).distance, 0.5, 1e-12);
  EXPECT_NEAR(table.nearest({2, -1, 2}).distance, std::sqrt(3), 1e-12);
}

TEST(Collider, VerticesSplitAtASeamMakeNoRim) {
  // The box again, but every triangle has vertices of its own.
  const TriangleMesh whole = surface_of(standing_box());
  TriangleMesh split;
  split.V.resize(3 * whole.F.rows(), 3);
  split.F.resize(whole.F.rows(), 3);
  for (Eigen::Index f = 0; f < whole.F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      split.V.row(3 * f + k) = whole.V.row(whole.F(f, k));
      split.F(f, k) = static_cast<int>(3 * f + k);
    }
  }
  const Collider a("whole", whole, 1), b("split", split, 1);
  CounterRng rng(6);
  for (int trial = 0; trial < 200; ++trial) {
    const Vector p = random_vector(3, 1, rng);
    EXPECT_NEAR(a.nearest(p).distance, b.nearest(p).distance, 1e-12);
  }
}

TEST(Collider, RefusesEmptyAndDegenerateSurfaces) {
  TriangleMesh flat_triangle{Points::Zero(3, 3), Triangles(1, 3), {}, {}, {}};
  flat_triangle.F << 0, 1, 2;
  EXPECT_THROW(Collider("dot", flat_triangle, 1), Error);
  EXPECT_THROW(Collider("nothing", {Points::Zero(3, 3), Triangles(0, 3), {}, {}, {}}, 1), Error);
}

}  // namespace
}  // namespace vivify::sim
