#include "sim/control/walking_balance.h"

#include <algorithm>
#include <cmath>

namespace vivify::sim {
namespace {

constexpr double kEdge = 0.9;  // share of the support within which is pushed

class Shifting final : public WalkingBalance {
 public:
  Eigen::Vector3d push(const Stance& now) const override {
    return (now.phase == Stance::swing ? now.staying : now.loaded).nearest(wanted_push(now), kEdge);
  }
  bool can_step(const Stance& now) const override {
    const Eigen::Vector3d push = wanted_push(now);
    return now.staying.nearest(push, kLiftEdge) == push;
  }
  bool must_land(const Stance& now) const override {
    const Eigen::Vector3d falling = now.capture_point - now.staying.nearest(now.capture_point);
    return falling.norm() > kLargestFall * now.height;
  }
  Eigen::Vector3d further(const Stance&) const override { return Eigen::Vector3d::Zero(); }
  double forgetting() const override { return 1.5; }

 private:
  static constexpr double kCaptureGain = 4;  // push beyond the capture point, per distance that it is off
  static constexpr double kLiftEdge =
      0.8;                               // share of the support with which a foot can do without the others
  static constexpr double kInset = 0.5;  // and above which the centre of mass is brought
  static constexpr double kLargestFall = 0.1;  // of the height: capture point beside the support

  // The capture point shall be above the feet that stay, on the side of the one that steps, which can catch a
  // fall to its side only.
  static Eigen::Vector3d wanted_push(const Stance& now) {
    const Eigen::Vector3d aim =
        now.phase == Stance::stand ? now.loaded.middle() : now.staying.nearest(now.every.middle(), kInset);
    return now.capture_point + kCaptureGain * (now.capture_point - aim);
  }
};

// Pushed at the middle s of the feet that stay, the capture point falls from s + b to s + e b, e = exp(ω T),
// while the other foot goes to s + a + f: apart from the others by a, where it belongs, and onward by f. With
// b = a / (1 + e) + f / (e − 1) the next step, by f − a, begins as this one did.
class Rocking final : public WalkingBalance {
 public:
  Eigen::Vector3d push(const Stance& now) const override {
    return (now.phase == Stance::swing ? now.staying : now.every).nearest(wanted_push(now), kEdge);
  }
  // Whether it will be there in time.
  bool can_step(const Stance& now) const override {
    return (falls_to(now) - now.landing).norm() < (now.staying.middle() - now.landing).norm();
  }
  bool must_land(const Stance&) const override { return false; }
  Eigen::Vector3d further(const Stance& now) const override {
    const Eigen::Vector3d step = kCatch * (falls_to(now) - aim(now));
    const double most = kLongestCatch * now.height;
    return step.norm() > most ? most * step.normalized() : step;
  }
  double forgetting() const override { return 10; }

 private:
  static constexpr double kShortestFall = 0.4;  // of a step: time in which a push leads the capture point
  static constexpr double kCatch = 0.3;         // share of a miss of the capture point that a foot follows
  static constexpr double kLongestCatch = 0.1;  // of the height

  static double growth(const Stance& now, double duration) { return std::exp(now.pendulum * duration); }
  // To lead the capture point to its aim.
  static double time_left(const Stance& now) { return std::max(now.left_s, kShortestFall * now.swing_s); }

  // Of the capture point, when the foot that steps has landed, or begins to.
  static Eigen::Vector3d aim(const Stance& now) {
    if (now.phase == Stance::stand) return now.every.middle();
    const double e = growth(now, now.swing_s);
    const Eigen::Vector3d s = now.staying.middle();
    const Eigen::Vector3d b = (now.belongs - s) / (1 + e) + (now.landing - now.belongs) / (e - 1);
    return s + (now.phase == Stance::swing ? e : 1) * b;
  }
  static Eigen::Vector3d wanted_push(const Stance& now) {
    return now.capture_point + (now.capture_point - aim(now)) / (growth(now, time_left(now)) - 1);
  }
  // Where the capture point is when the foot that steps has landed.
  static Eigen::Vector3d falls_to(const Stance& now) {
    const Eigen::Vector3d push = now.staying.nearest(wanted_push(now), kEdge);
    return push + growth(now, time_left(now)) * (now.capture_point - push);
  }
};

}  // namespace

std::unique_ptr<WalkingBalance> make_walking_balance(bool planar) {
  if (planar) return std::make_unique<Shifting>();
  return std::make_unique<Rocking>();
}

}  // namespace vivify::sim
