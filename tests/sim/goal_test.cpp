// Goals (6)–(10) and the motion of a body as a whole.
#include "sim/control/goal.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "sim/control/rigid_motion.h"
#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

struct Cloud {
  explicit Cloud(std::uint64_t seed) {
    CounterRng rng(seed);
    x_n = random_vector(60, 1, rng);
    x = x_n + random_vector(60, 0.1, rng);
    mass = random_vector(20, 1, rng).cwiseAbs().array() + 0.1;
    axis = Eigen::Vector3d(random_vector(3, 1, rng)).normalized();
    omega = random_vector(3, 2, rng);
    shift = random_vector(3, 2, rng);
    R = random_rotation(rng);
  }
  Vector x_n, x, mass;
  Eigen::Vector3d axis, omega, shift;
  Eigen::Matrix3d R;
};

TEST(Goals, RowsAreEquation8) {
  CounterRng rng(1);
  const Cloud cloud(1);
  const double h = 0.02;
  std::vector<Goal> goals;
  for (int i = 0; i < 6; ++i) {
    const double kp = i == 1 ? 0 : rng.uniform(0.5, 4), kd = i == 2 ? 0 : rng.uniform(0.5, 4);
    goals.push_back({random_vector(60, 1, rng), kp, kd, rng.uniform(-1, 1), rng.uniform(-1, 1)});
  }
  const Goals rows = make_goals(goals, cloud.x_n, h);
  ASSERT_EQ(rows.size(), 6);
  const Vector residual = rows.residual(cloud.x);
  for (int i = 0; i < 6; ++i) {
    const Goal& g = goals[static_cast<std::size_t>(i)];
    const double expected =
        g.kp * (g.a.dot(cloud.x) - g.sx) + g.kd * (g.a.dot(cloud.x - cloud.x_n) / h - g.sv);
    EXPECT_NEAR(residual[i], expected, 1e-12 * (1 + std::abs(expected) + std::abs(rows.s[i])));
  }
}

// The printed (9) has the opposite signs; without k_p the target must be a·x_n + h s_v.
TEST(Goals, TargetOfAVelocityGoal) {
  const Cloud cloud(2);
  const double h = 0.02, sv = 1.3, kd = 2;
  const Vector a = centre_of_mass_weights(cloud.mass, cloud.axis);
  const Goals rows = make_goals({{a, 0, kd, 99, sv}}, cloud.x_n, h);
  EXPECT_NEAR(rows.s[0] / (kd / h), a.dot(cloud.x_n) + h * sv, 1e-12);
  EXPECT_LE((rows.G.row(0).transpose() - kd / h * a).norm(), 1e-12);
}

TEST(Goals, WithoutWeightThereIsNoRow) {
  const Cloud cloud(3);
  const Vector a = centre_of_mass_weights(cloud.mass, cloud.axis);
  const Goals rows = make_goals({{a, 0, 0, 1, 1}, {a, 1, 0, 1, 1}, {a, 0, 0, 1, 1}}, cloud.x_n, 0.02);
  EXPECT_EQ(rows.size(), 1);
  EXPECT_EQ(rows.G.rows(), 1);
  EXPECT_NEAR(rows.residual(cloud.x)[0], a.dot(cloud.x) - 1, 1e-14);
  EXPECT_EQ(make_goals({}, cloud.x_n, 0.02).residual(cloud.x).size(), 0);
}

TEST(Goals, CentreOfMassWeights) {
  const Cloud cloud(4);
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (int i = 0; i < 20; ++i) centre += cloud.mass[i] * cloud.x.segment<3>(3 * i);
  centre /= cloud.mass.sum();
  EXPECT_NEAR(centre_of_mass_weights(cloud.mass, cloud.axis).dot(cloud.x), cloud.axis.dot(centre), 1e-13);
  EXPECT_LE((centre_of_mass(cloud.mass, cloud.x) - centre).norm(), 1e-14);
}

TEST(Goals, SpinIsTheAngularVelocityOfARigidMotion) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Cloud cloud(seed);
    Vector v(60);
    for (int i = 0; i < 20; ++i) {
      v.segment<3>(3 * i) = cloud.omega.cross(Eigen::Vector3d(cloud.x_n.segment<3>(3 * i))) + cloud.shift;
    }
    const Vector a = spin_weights(cloud.mass, cloud.x_n, cloud.axis);
    EXPECT_NEAR(a.dot(v), cloud.axis.dot(cloud.omega), 1e-11);
    // And the angular momentum is I ω.
    EXPECT_LE(
        (angular_momentum(cloud.mass, cloud.x_n, v) - inertia_tensor(cloud.mass, cloud.x_n) * cloud.omega)
            .norm(),
        1e-11);
    // Blind to the motion of the whole and to breathing.
    Vector breathing(60);
    const Eigen::Vector3d centre = centre_of_mass(cloud.mass, cloud.x_n);
    for (int i = 0; i < 20; ++i) breathing.segment<3>(3 * i) = cloud.x_n.segment<3>(3 * i) - centre;
    EXPECT_NEAR(a.dot(breathing), 0, 1e-12);
  }
}

TEST(RigidMotion, BestRotationFindsTheRotation) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Cloud cloud(seed);
    EXPECT_LE((best_rotation(cloud.mass, cloud.x_n, rigid(cloud.R, cloud.shift, cloud.x_n)) - cloud.R).norm(),
              1e-12);
  }
}

TEST(RigidMotion, BestRotationIsARotationAndTheBestEvenForReflections) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Cloud cloud(seed);
    CounterRng rng(seed);
    Vector x = rigid(cloud.R, cloud.shift, cloud.x_n) + random_vector(60, 0.3, rng);
    if (seed % 2 == 0) {
      for (int i = 0; i < 60; i += 3) x[i] = -x[i];  // mirrored
    }
    const Eigen::Matrix3d R = best_rotation(cloud.mass, cloud.x_n, x);
    EXPECT_LE((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_NEAR(R.determinant(), 1, 1e-12);
    const Eigen::Vector3d from = centre_of_mass(cloud.mass, cloud.x_n), to = centre_of_mass(cloud.mass, x);
    const auto cost = [&](const Eigen::Matrix3d& Q) {
      double sum = 0;
      for (int i = 0; i < 20; ++i) {
        sum += cloud.mass[i] *
               (Q * (cloud.x_n.segment<3>(3 * i) - from) - (x.segment<3>(3 * i) - to)).squaredNorm();
      }
      return sum;
    };
    for (int trial = 0; trial < 100; ++trial) EXPECT_GE(cost(random_rotation(rng)), cost(R) - 1e-12);
    for (int axis = 0; axis < 3; ++axis) {
      for (const double angle : {-0.01, 0.01}) {
        const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, Eigen::Vector3d::Unit(axis)).toRotationMatrix();
        EXPECT_GT(cost(turn * R), cost(R));
      }
    }
  }
}

TEST(RigidMotion, WhatIsInThePlaneTurnsInIt) {
  const double angle = 2.5;
  const Eigen::Rotation2Dd turn(angle);
  const Vector mass = Vector::LinSpaced(4, 1, 2);
  const RowMatrixXd line{{0, 0}, {0.1, 0}, {0.3, 0}, {0.4, 0}}, shape{{0, 0}, {1, 0}, {1, 0.7}, {0, 0.4}};
  for (const RowMatrixXd& rest : {line, shape}) {
    const RowMatrixXd turned = rest * turn.toRotationMatrix().transpose();
    const Eigen::Matrix3d R = best_rotation(mass, flat(rest), flat(turned));
    EXPECT_NEAR(R(0, 0), std::cos(angle), 1e-12);
    EXPECT_NEAR(R(1, 0), std::sin(angle), 1e-12);
    EXPECT_NEAR(R(2, 2), 1, 1e-12);
  }
  const RowMatrixXd mirrored = shape * Eigen::Vector2d(1, -1).asDiagonal();
  EXPECT_NEAR(best_rotation(mass, flat(shape), flat(mirrored))(2, 2), 1, 1e-12);
}

}  // namespace
}  // namespace vivify::sim
