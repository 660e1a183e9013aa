// Normal force, friction, contact sets and contact points.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "sim/contact/contact_points.h"
#include "sim/contact/contact_set.h"
#include "sim/contact/normal_force.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

TEST(NormalForce, NeverPullsAndIsTwiceDifferentiable) {
  const NormalForce normal{2000, 0.01};
  EXPECT_DOUBLE_EQ(normal.force(0), 2000 * 0.01 * 0.01);
  for (double d = -0.03; d < 0.03; d += 0.0007) {
    EXPECT_GE(normal.force(d), 0);
    EXPECT_GE(normal.second(d), 0);
    if (d > 0.01) {
      EXPECT_EQ(normal.force(d), 0);
      EXPECT_EQ(normal.energy(d), 0);
    }
    const double eps = 1e-6;
    EXPECT_NEAR(-normal.force(d), (normal.energy(d + eps) - normal.energy(d - eps)) / (2 * eps), 1e-6);
    EXPECT_NEAR(normal.second(d), -(normal.force(d + eps) - normal.force(d - eps)) / (2 * eps), 1e-6 * 100);
    EXPECT_NEAR(normal.third(d), (normal.second(d + eps) - normal.second(d - eps)) / (2 * eps), 1e-3);
  }
  EXPECT_NEAR(normal.second(0.01 - 1e-12), normal.second(0.01 + 1e-12), 1e-8);
}

class FrictionTest : public ::testing::Test {
 protected:
  const double k = 4000, limit = 12;
  const Friction friction{k, limit};
  const double slip = friction.slip_limit();
};

TEST_F(FrictionTest, SticksUpToCoulombsLimit) {
  EXPECT_DOUBLE_EQ(slip, 2 * limit / k);
  CounterRng rng(1);
  for (int trial = 0; trial < 300; ++trial) {
    const Eigen::Vector3d u = random_vector(3, 2 * slip, rng);
    const Eigen::Vector3d g = friction.gradient(u);
    EXPECT_LE(g.norm(), limit * (1 + 1e-14));
    EXPECT_GE(g.dot(u), 0);                              // against the motion
    EXPECT_LE(g.cross(u).norm(), 1e-14 * limit * slip);  // along it
    if (u.norm() >= slip) {
      EXPECT_NEAR(g.norm(), limit, 1e-12 * limit);
    } else {
      const double y = u.norm() / slip;
      EXPECT_NEAR(g.norm(), limit * (2 * y - y * y), 1e-12 * limit);
    }
  }
}

TEST_F(FrictionTest, DerivativesInStickAndSlip) {
  CounterRng rng(2);
  for (const double factor : {0.05, 0.5, 0.9, 1.1, 3.0}) {
    const Eigen::Vector3d direction = Eigen::Vector3d(random_vector(3, 1, rng)).normalized();
    const Vector u = factor * slip * direction, w = random_vector(3, 1, rng), d = random_vector(3, 1, rng);
    const auto energy = [&](const Vector& v) { return Vector::Constant(1, friction.energy(v)); };
    const auto gradient = [&](const Vector& v) { return Vector(friction.gradient(v)); };
    const auto hessian = [&](const Vector& v) { return Vector(friction.hessian(v) * d.head<3>()); };
    const double eps = 1e-5 * slip;
    EXPECT_LE(relative(friction.gradient(u).transpose(), differences(energy, u, eps)), 1e-6);
    EXPECT_LE(relative(friction.hessian(u), differences(gradient, u, eps)), 1e-6);
    const Vector third = friction.third(u, w) * d.head<3>();
    EXPECT_LE(relative(third, differences(hessian, u, eps) * w), 1e-6);
    const double step = 0.01 * factor * slip;
    EXPECT_NEAR(
        convergence(energy, u, w, Vector::Constant(1, friction.gradient(u).dot(Eigen::Vector3d(w))), step), 4,
        0.1);
    EXPECT_NEAR(convergence(gradient, u, w, friction.hessian(u) * w.head<3>(), step), 4, 0.1);
  }
}

TEST_F(FrictionTest, IsOnceDifferentiableAtTheSwitch) {
  const Eigen::Vector3d e = Eigen::Vector3d(1, 2, -2) / 3;
  const double below = slip * (1 - 1e-9), beyond = slip * (1 + 1e-9);
  EXPECT_NEAR(friction.energy(below * e), friction.energy(beyond * e), 1e-7 * friction.energy(beyond * e));
  EXPECT_LE((friction.gradient(below * e) - friction.gradient(beyond * e)).norm(), 1e-8 * limit);
  // Even the stiffness is continuous there: it falls to zero along e.
  EXPECT_LE((friction.hessian(below * e) - friction.hessian(beyond * e)).norm(), 1e-6 * k);
  EXPECT_LE((friction.hessian(Eigen::Vector3d::Zero()) - k * Eigen::Matrix3d::Identity()).norm(), 1e-9);
  EXPECT_LE((friction.hessian(1e-12 * slip * e) - k * Eigen::Matrix3d::Identity()).norm(), 1e-6 * k);
}

TEST_F(FrictionTest, ReturnMapDragsTheAnchor) {
  const Eigen::Vector3d e = Eigen::Vector3d(2, 1, 2) / 3;
  EXPECT_EQ(friction.return_map(0.7 * slip * e), 0.7 * slip * e);
  EXPECT_LE((friction.return_map(5 * slip * e) - slip * e).norm(), 1e-15);
  // The force does not change when the anchor is dragged.
  EXPECT_LE((friction.gradient(friction.return_map(5 * slip * e)) - friction.gradient(5 * slip * e)).norm(),
            1e-12);
}

TEST_F(FrictionTest, NoneAndUnlimited) {
  const Eigen::Vector3d u(0.1, 0.2, 0.3);
  const Friction none(k, 0), unlimited(k, INFINITY);
  EXPECT_EQ(none.energy(u), 0);
  EXPECT_EQ(none.gradient(u).norm(), 0);
  EXPECT_EQ(none.hessian(u).norm(), 0);
  EXPECT_EQ(none.return_map(u).norm(), 0);
  EXPECT_EQ(unlimited.gradient(u), k * u);
  EXPECT_EQ(unlimited.hessian(u), k * Eigen::Matrix3d::Identity());
  EXPECT_DOUBLE_EQ(unlimited.energy(u), 0.5 * k * u.squaredNorm());
  EXPECT_EQ(unlimited.return_map(u), u);
}

// One tetrahedron with one contact point, its first vertex.
struct OnePoint {
  OnePoint() {
    points.vertices.resize(1, 4);
    points.weights.resize(1, 4);
    points.vertices << 0, 1, 2, 3;
    points.weights << 1, 0, 0, 0;
  }
  static Vector at(const Eigen::Vector3d& y) {
    Vector x = Vector::Constant(12, 1);
    x.head<3>() = y;
    return x;
  }
  ContactPoints points;
  ContactParameters parameters = {0.01, 1e5, 1000};
};

TEST(ContactSet, AnchorsAreSetDraggedAndDropped) {
  const OnePoint one_point;
  const std::vector<Collider> colliders = one(plane(0.5));
  std::vector<ContactMemory> memory(1);
  const auto step = [&](const Eigen::Vector3d& y) {
    const ContactSet set(one_point.points, one_point.parameters, colliders, OnePoint::at(y), 0.1, memory);
    set.update_memory(OnePoint::at(y), memory);
  };
  step({0, 0.02, 0});
  EXPECT_FALSE(memory[0].touching);
  step({0, 0, 0});
  EXPECT_TRUE(memory[0].touching);
  EXPECT_NEAR(memory[0].normal_force, 1e5 * 1e-4, 1e-9);
  EXPECT_EQ(memory[0].anchor, Eigen::Vector3d(0, 0, 0));
  const double slip = 2 * 0.5 * 10 / 1000;
  step({0.5 * slip, 0, 0});  // sticks: the anchor stays
  EXPECT_LE((memory[0].anchor - Eigen::Vector3d(0, 0, 0)).norm(), 1e-15);
  step({3 * slip, 0, 0});  // slips: the anchor follows
  EXPECT_LE((memory[0].anchor - Eigen::Vector3d(2 * slip, 0, 0)).norm(), 1e-14);
  step({3 * slip, 0.011, 0});
  EXPECT_FALSE(memory[0].touching);
  EXPECT_EQ(memory[0].normal_force, 0);
}

TEST(ContactSet, FrictionBelongsToTheColliderThatWasTouched) {
  const OnePoint one_point;
  // A floor that is touched, and a wall of infinite friction that is near but not touched.
  std::vector<Collider> colliders = one(plane(0.5));
  colliders.push_back(plane(INFINITY, {-1, 0, 0}, {0.05, 0, 0}));
  std::vector<ContactMemory> memory(1);
  const Vector x = OnePoint::at({0, 0.002, 0});
  ContactSet(one_point.points, one_point.parameters, colliders, x, 0.1, memory).update_memory(x, memory);
  ASSERT_TRUE(memory[0].touching);
  const Vector moved =
      OnePoint::at({0.001, 0.02, 0.003});  // above the floor's layer: friction is all there is
  const ContactSet both(one_point.points, one_point.parameters, colliders, x, 0.1, memory);
  EXPECT_EQ(both.contacts().size(), 2u);
  const Eigen::Vector3d force = both.total_force(moved);
  EXPECT_EQ(force.y(), 0) << "only the wall can push along y";
  EXPECT_LE(force.norm(), 0.5 * memory[0].normal_force);
}

TEST(ContactSet, PlanesHoldOnAPlaneAndNotAroundACorner) {
  const OnePoint one_point;
  const std::vector<Collider> floor = one(plane(1));
  const std::vector<ContactMemory> memory(1);
  const ContactSet on_floor(one_point.points, one_point.parameters, floor, OnePoint::at({0, 0, 0}), 0.1,
                            memory);
  EXPECT_TRUE(on_floor.planes_hold(floor, OnePoint::at({3, -0.005, 2}), 1e-9));
  // Over the edge of the square.
  const ContactSet at_edge(one_point.points, one_point.parameters, floor, OnePoint::at({49.99, 0, 0}), 0.1,
                           memory);
  EXPECT_TRUE(at_edge.planes_hold(floor, OnePoint::at({49.999, 0, 0}), 1e-3));
  EXPECT_FALSE(at_edge.planes_hold(floor, OnePoint::at({50.02, -0.005, 0}), 1e-3));
}

TEST(ContactPoints, HalfOfThemStandOnTheGroundAndAllAreSpread) {
  const TetMesh mesh = standing_box();
  Tetrahedra vertices(mesh.V.rows(), 4);
  Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor> weights(mesh.V.rows(), 4);
  for (int i = 0; i < mesh.V.rows(); ++i) {
    vertices.row(i) << i, 0, 0, 0;
    weights.row(i) << 1, 0, 0, 0;
  }
  const ContactPoints points = select_contact_points(mesh.V, vertices, weights, 3, 24);
  ASSERT_EQ(points.size(), 24);
  const Vector x = flat(mesh.V);
  EXPECT_GE(count_standing_points(points, x), 12);
  std::set<int> distinct;
  for (int i = 0; i < points.size(); ++i) distinct.insert(points.vertices(i, 0));
  EXPECT_EQ(distinct.size(), 24u);
  // Farthest points: all corners of the box are among them.
  for (int c = 0; c < 8; ++c) {
    const Eigen::Vector3d corner(c & 1 ? 0.4 : -0.4, c & 2 ? 1 : 0, c & 4 ? 0.4 : -0.4);
    double nearest = INFINITY;
    for (int i = 0; i < points.size(); ++i)
      nearest = std::min(nearest, (points.position(i, x) - corner).norm());
    EXPECT_LE(nearest, 0.3);
  }
  EXPECT_EQ(select_contact_points(mesh.V, vertices, weights, 3, 1000).size(), mesh.V.rows());
}

TEST(Ground, IsWhatPushesUpwards) {
  const double slope = 60 * std::numbers::pi / 180;
  const Eigen::Vector3d belt(2, 0, 0);
  const auto facing = [&](const Eigen::Vector3d& normal) {
    ShapePlace place;
    place.pose.linear() =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitY(), normal).toRotationMatrix();
    return Collider("plane", make_collider_shape(settings(collider_shape_schema(), "{type: plane}"), place),
                    1, {}, belt);
  };
  std::vector<Collider> colliders;
  colliders.push_back(facing({0, 1, 0}));
  colliders.push_back(facing({0, 0, 1}));  // a wall
  colliders.push_back(facing({0, std::cos(slope), std::sin(slope)}));
  colliders.push_back(facing({0, -1, 0}));  // a ceiling
  std::vector<ContactMemory> memory;
  for (int c = 0; c < 4; ++c) memory.push_back({true, Eigen::Vector3d::Zero(), 3.0 + c, c});
  memory.push_back({false, Eigen::Vector3d::Zero(), 0, -1});
  const auto under = [&](std::vector<int> points) {
    std::vector<ContactMemory> some;
    for (const int i : points) some.push_back(memory[static_cast<std::size_t>(i)]);
    return ground_under(some, colliders, 0, 0.01);
  };
  EXPECT_NEAR(under({0, 1, 2, 3, 4}).load, 3 + 5 * std::cos(slope), 1e-12);
  EXPECT_NEAR(under({2}).load, 5 * std::cos(slope), 1e-12);
  ASSERT_TRUE(under({0, 1, 2}).velocity);
  EXPECT_LE((*under({0, 1, 2}).velocity - belt).norm(), 1e-12);
  EXPECT_EQ(under({3, 4}).load, 0);
  EXPECT_FALSE(under({3, 4}).velocity);
}

}  // namespace
}  // namespace vivify::sim
