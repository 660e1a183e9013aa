// Keyframed motion: it meets its keys, is smooth, never overshoots, and refuses jumps.
#include "sim/contact/rigid_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/sim/fixtures.h"

namespace vivify::sim {
namespace {

const Eigen::Vector3d kOrigin = Eigen::Vector3d::Zero();

Eigen::Matrix3d turn(const Eigen::Vector3d& degrees) {
  const auto about = [&](int axis) {
    return Eigen::AngleAxisd(degrees[axis] * std::numbers::pi / 180, Eigen::Vector3d::Unit(axis))
        .toRotationMatrix();
  };
  return about(2) * about(1) * about(0);
}

std::vector<RigidKey> random_keys(int count, CounterRng& rng) {
  std::vector<RigidKey> keys;
  double t = rng.uniform(-1, 1);
  for (int i = 0; i < count; ++i) {
    keys.push_back({t, random_vector(3, 2, rng), random_vector(3, 400, rng), {}});
    t += rng.uniform(0.3, 1);
  }
  return keys;
}

// Twelve numbers that say all of a pose.
Vector numbers(const RigidPath& path, double t) {
  const Eigen::Isometry3d pose = path.pose(t);
  return Eigen::Map<const Vector>(Eigen::Matrix<double, 3, 4>(pose.affine()).eval().data(), 12);
}

TEST(RigidPath, WithoutKeysRestsAtTheIdentity) {
  const RigidPath path;
  EXPECT_FALSE(path.moves());
  EXPECT_TRUE(path.pose(3).matrix().isIdentity(0));
}

TEST(RigidPath, MeetsItsKeysAndStaysBeforeAndAfter) {
  CounterRng rng(1);
  for (int trial = 0; trial < 20; ++trial) {
    const std::vector<RigidKey> keys = random_keys(5, rng);
    const RigidPath path(keys, false);
    EXPECT_TRUE(path.moves());
    for (const RigidKey& key : keys) {
      const Eigen::Isometry3d pose = path.pose(key.t);
      EXPECT_LE((pose.translation() - key.position).norm(), 1e-12);
      EXPECT_LE((pose.linear() - turn(key.turns_deg)).norm(), 1e-12);
    }
    EXPECT_EQ(numbers(path, keys.front().t - 5), numbers(path, keys.front().t));
    EXPECT_EQ(numbers(path, keys.back().t + 5), numbers(path, keys.back().t));
  }
}

// The slope to the left of any time is that to its right: at the keys, and at both ends, where it is zero.
TEST(RigidPath, VelocityIsContinuous) {
  CounterRng rng(2);
  const double eps = 1e-5;
  for (int trial = 0; trial < 20; ++trial) {
    const std::vector<RigidKey> keys = random_keys(5, rng);
    const RigidPath path(keys, false);
    for (const RigidKey& key : keys) {
      const Vector before = (numbers(path, key.t) - numbers(path, key.t - eps)) / eps;
      const Vector after = (numbers(path, key.t + eps) - numbers(path, key.t)) / eps;
      EXPECT_LE((after - before).norm(), 0.1);  // accelerations of 10⁴ /s² times the step
      const bool end = key.t == keys.front().t || key.t == keys.back().t;
      EXPECT_LE(end ? after.norm() + before.norm() : 0, 0.1);
    }
    EXPECT_GT((numbers(path, keys[1].t + 0.1) - numbers(path, keys[1].t)).norm(), 1e-3);
  }
}

TEST(RigidPath, StaysBetweenTwoKeysInEveryCoordinate) {
  CounterRng rng(3);
  for (int trial = 0; trial < 20; ++trial) {
    const std::vector<RigidKey> keys = random_keys(4, rng);
    const RigidPath path(keys, false);
    for (std::size_t i = 1; i < keys.size(); ++i) {
      const Eigen::Vector3d low = keys[i - 1].position.cwiseMin(keys[i].position);
      const Eigen::Vector3d high = keys[i - 1].position.cwiseMax(keys[i].position);
      for (double s = 0; s <= 1; s += 0.01) {
        const Eigen::Vector3d p = path.pose((1 - s) * keys[i - 1].t + s * keys[i].t).translation();
        EXPECT_LE((low - p).maxCoeff(), 1e-12);
        EXPECT_LE((p - high).maxCoeff(), 1e-12);
      }
    }
  }
}

TEST(RigidPath, EvenKeysMakeAnEvenSpeedBetweenTheEnds) {
  std::vector<RigidKey> keys;
  for (int i = 0; i < 5; ++i) keys.push_back({0.5 * i, {0.2 * i, 0, 0}, {0, 30.0 * i, 0}, {}});
  const RigidPath path(keys, false);
  for (const double t : {0.6, 0.77, 1.3}) {  // away from the first and the last interval
    EXPECT_NEAR(path.pose(t).translation().x(), 0.4 * t, 1e-12);
    EXPECT_LE((path.pose(t).linear() - turn({0, 60 * t, 0})).norm(), 1e-12);
  }
}

TEST(RigidPath, TwoKeysMakeWholeTurns) {
  const RigidPath path({{0, kOrigin, {0, 0, 0}, {}}, {1, kOrigin, {0, 720, 0}, {}}}, false);
  EXPECT_LE((path.pose(0.5).linear() - turn({0, 360, 0})).norm(), 1e-12);
  EXPECT_GT((path.pose(0.25).linear() - turn({0, 0, 0})).norm(), 0.5);
}

TEST(RigidPath, RepeatsWithItsVelocity) {
  CounterRng rng(4);
  std::vector<RigidKey> keys = random_keys(5, rng);
  keys.back().position = keys.front().position;
  keys.back().turns_deg = keys.front().turns_deg + Eigen::Vector3d(360, 0, -360);
  const RigidPath path(keys, true);
  const double period = keys.back().t - keys.front().t, eps = 1e-5;
  for (const double t : {-3.0, 0.1, 0.2, 2.0}) {
    EXPECT_LE((numbers(path, t) - numbers(path, t + period)).norm(), 1e-9);
    EXPECT_LE((numbers(path, t) - numbers(path, t - 3 * period)).norm(), 1e-9);
  }
  for (const RigidKey& key : keys) {
    const Vector before = (numbers(path, key.t) - numbers(path, key.t - eps)) / eps;
    const Vector after = (numbers(path, key.t + eps) - numbers(path, key.t)) / eps;
    EXPECT_LE((after - before).norm(), 0.1);
  }
}

TEST(RigidPath, ARepeatedTurnIsEven) {
  const RigidPath table({{0, kOrigin, {0, 0, 0}, {}}, {4, kOrigin, {0, 360, 0}, {}}}, true);
  for (const double t : {0.3, 3.9, 4.1, 11.0, -1.0}) {
    EXPECT_LE((table.pose(t).linear() - turn({0, 90 * t, 0})).norm(), 1e-12) << t;
  }
}

std::string refusal(const std::vector<RigidKey>& keys, bool repeats = false) {
  try {
    const RigidPath path(keys, repeats, "colliders[3].motion");
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    return error.full_text();
  }
  return "accepted";
}

TEST(RigidPath, RefusesJumps) {
  using testing::HasSubstr;
  const auto key = [](double t, double x, double turned = 0) {
    return RigidKey{t, {x, 0, 0}, {turned, 0, 0}, {"scene.yaml", 7, 5}};
  };
  const std::string twice = refusal({key(0, 0), key(1, 0), key(1, 2)});
  EXPECT_THAT(twice, HasSubstr("scene.yaml:7:5: error: colliders[3].motion[2].t_s = 1 s is not after"));
  EXPECT_THAT(twice, HasSubstr("cannot jump"));
  EXPECT_THAT(refusal({key(0, 0), key(1, 0), key(0.5, 2)}), HasSubstr("in the order of time"));
  EXPECT_THAT(refusal({key(0, 0), key(0.01, 1.1)}), HasSubstr("motion[1] jumps: 1.1 m"));
  EXPECT_EQ(refusal({key(0, 0), key(0.01, 0.9)}), "accepted");
  EXPECT_THAT(refusal({key(0, 0), key(0.01, 0, 40)}), HasSubstr("motion[1] jumps: 40°"));
  EXPECT_EQ(refusal({key(0, 0), key(0.01, 0, 30)}), "accepted");
  EXPECT_THAT(refusal({key(0, 0), key(1, 0.1)}, true), HasSubstr("motion[1] jumps back to the first key"));
  EXPECT_THAT(refusal({key(0, 0), key(1, 0, 90)}, true), HasSubstr("jumps back"));
  EXPECT_EQ(refusal({key(0, 0), key(1, 0, 360)}, true), "accepted");
  EXPECT_THAT(refusal({key(0, 0)}, true), HasSubstr("needs two keys"));
}

}  // namespace
}  // namespace vivify::sim
