// Nearest points, signs and normals against closed forms and brute force.
#include "sim/contact/collider.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "common/error.h"
#include "sim/contact/shapes/shapes.h"
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

// Shapes, each put somewhere, with points of their frame far from where the distance has a kink.
struct Shape {
  const char* name;
  const char* settings;
};
void PrintTo(const Shape& shape, std::ostream* out) { *out << shape.name; }
constexpr Shape kShapes[] = {
    {"plane", "{type: plane, normal: [1, 3, -0.5], size: 8}"},
    {"sphere", "{type: sphere, radius: 0.7}"},
    {"capsule", "{type: capsule, from: [-0.5, 0, 0.2], to: [0.6, 0.3, 0], radius: 0.4}"},
    {"height_field",
     "{type: height_field, cell: [0.5, 0.4], heights: [[0, 0.2, 0.1, 0], [0.3, 0.1, -0.2, 0], [0, 0, 0.2, "
     "0.3]]}"},
};
const ShapePlace kPlace = {1.5, Eigen::Translation3d(0.3, -0.2, 0.1) *
                                    Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, 2, 3).normalized())};

class ColliderShapeTest : public testing::TestWithParam<Shape> {
 protected:
  std::unique_ptr<ColliderShape> make(const ShapePlace& place = {}) const {
    return make_collider_shape(settings(collider_shape_schema(), GetParam().settings), place);
  }
};

TEST(ColliderShapes, AreAllTested) {
  std::vector<std::string> known, tested;
  for (const ColliderShapeEntry& entry : collider_shapes()) known.emplace_back(entry.name);
  for (const Shape& shape : kShapes) tested.emplace_back(shape.name);
  EXPECT_EQ(known, tested);
}

// Distances from the drawn triangles, one by one; those of round shapes lie inside the shape by no more than
// the height of an arc of 5.6 degrees.
TEST_P(ColliderShapeTest, NearestPointIsThatOfTheDrawnTriangles) {
  const std::unique_ptr<ColliderShape> shape = make(kPlace);
  const TriangleMesh drawn = shape->drawing();
  const bool round = drawn.F.rows() > 100;
  const double tolerance = round ? 0.004 : 1e-12;
  CounterRng rng(7);
  int inside = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Eigen::Vector3d p = kPlace.point(random_vector(3, 1, rng));
    double best = INFINITY;
    for (int f = 0; f < drawn.F.rows(); ++f) {
      const auto corner = [&](int k) -> Eigen::Vector3d { return drawn.V.row(drawn.F(f, k)).transpose(); };
      best = std::min(best, (nearest_by_parts(p, {corner(0), corner(1), corner(2)}) - p).norm());
    }
    const SurfacePoint nearest = shape->nearest(p);
    EXPECT_NEAR(std::abs(nearest.distance), best, tolerance);
    EXPECT_NEAR((nearest.position - p).norm(), std::abs(nearest.distance), 1e-12);
    inside += nearest.distance < 0;
  }
  EXPECT_GT(inside, 5);
  EXPECT_LT(inside, 55);
}

TEST_P(ColliderShapeTest, NormalIsTheGradientOfTheDistance) {
  const std::unique_ptr<ColliderShape> shape = make(kPlace);
  CounterRng rng(8);
  int tested = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Vector p = kPlace.point(random_vector(3, 1.5, rng));
    const SurfacePoint nearest = shape->nearest(p);
    EXPECT_NEAR(nearest.normal.norm(), 1, 1e-12);
    // Inside, and over valleys of the ground, the gradient jumps where two places are equally near.
    const auto distance = [&](const Vector& y) { return Vector::Constant(1, shape->nearest(y).distance); };
    const Matrix gradient = differences(distance, p, 1e-6);
    if (std::abs(gradient.norm() - 1) > 1e-6) continue;
    EXPECT_LE((nearest.normal.transpose() - gradient).norm(), 1e-5) << p.transpose();
    ++tested;
  }
  EXPECT_GT(tested, 250);
}

TEST_P(ColliderShapeTest, MovesAndGrowsWithItsPlace) {
  const std::unique_ptr<ColliderShape> plain = make(), placed = make(kPlace);
  CounterRng rng(9);
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Vector3d p = random_vector(3, 1.5, rng);
    const SurfacePoint expected = plain->nearest(p), nearest = placed->nearest(kPlace.point(p));
    EXPECT_NEAR(nearest.distance, kPlace.scale * expected.distance, 1e-12);
    EXPECT_LE((nearest.position - kPlace.point(expected.position)).norm(), 1e-12);
    EXPECT_LE((nearest.normal - kPlace.pose.linear() * expected.normal).norm(), 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(All, ColliderShapeTest, testing::ValuesIn(kShapes),
                         [](const auto& parameter) { return std::string(parameter.param.name); });

std::unique_ptr<ColliderShape> shape(const char* yaml) {
  return make_collider_shape(settings(collider_shape_schema(), yaml), {});
}

TEST(ColliderShapes, DistancesAreThoseOfTheClosedForms) {
  const auto sphere = shape("{type: sphere, radius: 2}"), plane = shape("{type: plane, normal: [0, 0, 5]}"),
             capsule = shape("{type: capsule, from: [0, 0, 0], to: [0, 3, 0], radius: 1}");
  EXPECT_NEAR(sphere->nearest({3, 4, 0}).distance, 3, 1e-14);
  EXPECT_NEAR(sphere->nearest({0, 0.5, 0}).distance, -1.5, 1e-14);
  EXPECT_NEAR(plane->nearest({1e4, -7, -3}).distance, -3, 1e-14);  // it has no end
  EXPECT_NEAR(capsule->nearest({0.25, 1, 0}).distance, -0.75, 1e-14);
  EXPECT_NEAR(capsule->nearest({3, 7, 0}).distance, 4, 1e-14);
  EXPECT_NEAR(capsule->nearest({0, -1, 2}).distance, std::sqrt(5) - 1, 1e-14);
}

TEST(ColliderShapes, CentresHaveANormalToo) {
  const auto sphere = shape("{type: sphere, radius: 2}"),
             capsule = shape("{type: capsule, from: [0, 0, 0], to: [0, 3, 0], radius: 1}");
  EXPECT_NEAR(sphere->nearest({0, 0, 0}).normal.norm(), 1, 1e-14);
  EXPECT_EQ(sphere->nearest({0, 0, 0}).distance, -2);
  const SurfacePoint axis = capsule->nearest({0, 1, 0});
  EXPECT_NEAR(axis.distance, -1, 1e-14);
  EXPECT_NEAR(axis.normal.norm(), 1, 1e-14);
  EXPECT_NEAR(axis.normal.y(), 0, 1e-14);
}

// The ground of a bilinear function is that function on the edges of the grid.
TEST(ColliderShapes, HeightsAreMetOnTheGrid) {
  const auto ground = shape("{type: height_field, cell: [0.5, 2], heights: [[0, 1, 0], [2, 1, -1]]}");
  const TriangleMesh drawn = ground->drawing();
  EXPECT_EQ(drawn.F.rows(), 4);
  EXPECT_EQ(drawn.V.row(1), Eigen::RowVector3d(0, 1, -1));
  EXPECT_EQ(drawn.V.row(5), Eigen::RowVector3d(0.5, -1, 1));
  for (Eigen::Index v = 0; v < drawn.V.rows(); ++v) {
    EXPECT_NEAR(ground->nearest(drawn.V.row(v).transpose()).distance, 0, 1e-14);
  }
  EXPECT_GT(ground->nearest({0.1, 3, 0.3}).distance, 0);
  EXPECT_LT(ground->nearest({0.1, 0.3, 0.3}).distance, 0);
}

TEST(ColliderShapes, RefuseWhatMakesNoShape) {
  EXPECT_THROW(shape("{type: plane, normal: [0, 0, 0]}"), Error);
  EXPECT_THROW(shape("{type: sphere, radius: 0}"), Error);
  EXPECT_THROW(shape("{type: height_field, heights: [[0, 1], [0, 1, 2]]}"), Error);
  EXPECT_THROW(shape("{type: height_field, heights: [[0, 1]]}"), Error);
}

TEST(Collider, MovesItsShape) {
  const RigidPath path({{0, {0, 1, 0}, {0, 0, 0}, {}}, {2, {4, 1, 0}, {0, 0, 90}, {}}}, false);
  const Collider mover("mover", shape("{type: sphere, radius: 0.5}"), 0.3, path, {0, 0, 2});
  EXPECT_TRUE(mover.moves());
  EXPECT_EQ(mover.friction(), 0.3);
  EXPECT_EQ(mover.surface_velocity(), Eigen::Vector3d(0, 0, 2));
  EXPECT_NEAR(mover.nearest(mover.pose(1).inverse() * Eigen::Vector3d(2, 2, 0)).distance, 0.5, 1e-12);
  const Collider table = plane(1);
  EXPECT_FALSE(table.moves());
  EXPECT_TRUE(table.pose(1).matrix().isIdentity(0));
  EXPECT_TRUE(table.surface_velocity().isZero(0));
  EXPECT_THROW(mover.nearest({NAN, 0, 0}), Error);
  EXPECT_THROW(table.nearest({0, INFINITY, 0}), Error);
}

// The error that a surface is refused with.
std::string refusal(const TriangleMesh& surface) {
  try {
    const Collider collider("rock", surface, 1);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::geometry);
    EXPECT_NE(error.hint(), "");
    return error.what();
  }
  return "accepted";
}

TriangleMesh without_faces(TriangleMesh mesh, int count) {
  mesh.F.conservativeResize(mesh.F.rows() - count, 3);
  return mesh;
}

TriangleMesh inside_out(TriangleMesh mesh) {
  mesh.F.col(1).swap(mesh.F.col(2));
  return mesh;
}

TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh mesh{Points(a.V.rows() + b.V.rows(), 3), Triangles(a.F.rows() + b.F.rows(), 3), {}, {}, {}};
  mesh.V << a.V, b.V;
  mesh.F << a.F, (b.F.array() + static_cast<int>(a.V.rows())).matrix();
  return mesh;
}

TEST(ColliderSurface, WithAHoleIsRefused) {
  using testing::HasSubstr;
  const TriangleMesh box = surface_of(standing_box());
  const std::string one = refusal(without_faces(box, 1));
  EXPECT_THAT(one, HasSubstr("collider 'rock': a hole of 3 edges in a surface that is closed otherwise"));
  EXPECT_THAT(one, HasSubstr("from ("));
  TriangleMesh two = box;  // one at each end of the list
  two.F = box.F.middleRows(1, box.F.rows() - 2).eval();
  EXPECT_THAT(refusal(two), HasSubstr("2 holes of 6 edges"));
}

TEST(ColliderSurface, MayBeOpenWide) {
  // The box without its top is an open one.
  TriangleMesh box = surface_of(standing_box());
  Triangles kept(box.F.rows(), 3);
  Eigen::Index count = 0;
  for (const auto& face : box.F.rowwise()) {
    double lowest = INFINITY;
    for (int k = 0; k < 3; ++k) lowest = std::min(lowest, box.V(face[k], 1));
    if (lowest < 1) kept.row(count++) = face;
  }
  ASSERT_LT(count, box.F.rows());
  box.F = kept.topRows(count).eval();
  EXPECT_EQ(refusal(box), "accepted");
  // A sheet with a hole in it.
  TriangleMesh sheet =
      shape("{type: height_field, heights: [[0,0,0,0],[0,0,0,0],[0,0,0,0],[0,0,0,0]]}")->drawing();
  sheet.F.row(8) = sheet.F.row(17);  // 8 and 9 are the middle cell
  sheet.F.row(9) = sheet.F.row(16);
  EXPECT_EQ(refusal(without_faces(sheet, 2)), "accepted");
}

TEST(ColliderSurface, WithFlippedFacesIsRefused) {
  TriangleMesh box = surface_of(standing_box());
  std::swap(box.F(7, 0), box.F(7, 1));
  EXPECT_THAT(refusal(box),
              testing::HasSubstr("both sides of 3 edges face opposite ways, for example from ("));
}

TEST(ColliderSurface, ClosedAndInwardIsRefused) {
  const TriangleMesh box = surface_of(standing_box());
  EXPECT_THAT(refusal(inside_out(box)), testing::HasSubstr("closed and faces inward"));
  // Far from the origin too, beside another box; a cavity within it is right.
  TriangleMesh far = box, small = box;
  far.V.rowwise() += Eigen::RowVector3d(5, 0, 3);
  small.V *= 0.5;
  small.V.rowwise() += Eigen::RowVector3d(0, 0.25, 0);
  EXPECT_EQ(refusal(joined(box, far)), "accepted");
  EXPECT_THAT(refusal(joined(box, inside_out(far))), testing::HasSubstr("faces inward"));
  EXPECT_EQ(refusal(joined(box, inside_out(small))), "accepted");
}

TEST(ColliderSurface, OfTwoFacesBackToBackIsASheet) {
  TriangleMesh sheet = shape("{type: height_field, heights: [[0.1,0.2,0],[0.3,0.1,0.7]]}")->drawing();
  const TriangleMesh both = joined(sheet, inside_out(sheet));
  EXPECT_EQ(refusal(both), "accepted");
}

}  // namespace
}  // namespace vivify::sim
