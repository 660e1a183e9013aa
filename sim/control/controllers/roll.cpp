#include "sim/control/controllers/roll.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "sim/control/body_goals.h"
#include "sim/control/course.h"
#include "sim/control/rigid_motion.h"

namespace vivify::sim {
namespace {

constexpr double kHeightFrequency = 6;  // ω of the height goal, 1/s (k_p = ω k_d)
constexpr double kHeightWeight = 0.1;   // of the height goal, relative to that of the speed
constexpr double kLearning = 0.5;  // share of a missing speed that a second of rolling adds to what is asked
constexpr double kLargestLearnt = 1;   // of the wanted speed
constexpr double kLineFrequency = 1;   // share of a sideways offset that a second of rolling takes back
constexpr double kLargestSteer = 0.3;  // sideways speed, of the wanted one
constexpr double kHoldFrequency = 2;   // speed per distance from the end of the way, 1/s
constexpr double kSlow = 0.2;          // of the wanted speed: nearly standing

class RollController final : public Controller {
 public:
  RollController(const ControlledBody& body, const Value& settings)
      : body_(body),
        course_(body, settings),
        speed_(settings["speed"].as_number()),
        ramp_s_(settings["ramp_s"].as_number()),
        weight_(settings["effort"].as_number()),
        rest_rise_(rest_rise(body)) {}

  std::vector<Goal> goals(const Observation& now) override {
    rolling_ = stands(body_, now.load);
    if (!rolling_) return {};  // in the air no internal force moves the centre of mass
    time_ += body_.h;
    const Eigen::Vector3d centre = centre_of_mass(body_.mass, now.x), v = centre_of_mass(body_.mass, now.v);
    const Course::Way way = course_.way(centre, body_.height, now.others);
    arrived_ = arrived_ || (course_.ends(way) && v.norm() < kSlow * speed_);
    const double steer =
        std::clamp(-kLineFrequency * way.offset, -kLargestSteer * speed_, kLargestSteer * speed_);
    const Eigen::Vector3d aside = Eigen::Vector3d::UnitY().cross(way.forward);
    const Eigen::Vector3d wanted = wanted_speed(way.left) * way.forward + steer * aside;
    // Goals are tracked with a bias (they are weighed against the regulariser, and slopes pull): ask for more
    // where it falls short.
    learnt_ += kLearning * body_.h * (wanted - Eigen::Vector3d(v.x(), 0, v.z()));
    if (learnt_.norm() > kLargestLearnt * speed_) learnt_ *= kLargestLearnt * speed_ / learnt_.norm();
    const double ground = lowest_height(now.x, body_.dimension());
    BodyGoals goals(body_, now.x);
    for (const Eigen::Vector3d& direction : {way.forward, aside})
      goals.centre(direction, weight_, 0, 0, direction.dot(wanted + learnt_));
    goals.centre(Eigen::Vector3d::UnitY(), kHeightWeight * weight_, kHeightFrequency, ground + rest_rise_, 0);
    return goals.take();
  }

  bool arrived() const override { return arrived_; }
  std::string phase() const override { return !rolling_ ? "flight" : arrived_ ? "stand" : "roll"; }

  Eigen::VectorXd state() const override {
    Eigen::VectorXd state(6 + Course::kStateSize);
    state << rolling_, time_, learnt_, arrived_, course_.state();
    return state;
  }
  void restore(const Eigen::VectorXd& state) override {
    rolling_ = state[0] != 0;
    time_ = state[1];
    learnt_ = state.segment<3>(2);
    arrived_ = state[5] != 0;
    course_.restore(state.tail<Course::kStateSize>());
  }

 private:
  // Rises while it sets out, and falls as fast towards the end of the way.
  double wanted_speed(double left) const {
    const double braking = std::min(std::sqrt(2 * speed_ / ramp_s_ * left), kHoldFrequency * left);
    return std::min(speed_ * std::min(1.0, time_ / ramp_s_), braking);
  }

  ControlledBody body_;
  Course course_;
  double speed_, ramp_s_, weight_;
  double rest_rise_;  // of the centre of mass above the lowest vertex at rest, m

  bool rolling_ = false, arrived_ = false;
  double time_ = 0;                                   // spent on the ground, s
  Eigen::Vector3d learnt_ = Eigen::Vector3d::Zero();  // added to the velocity that is asked for, m/s
};

}  // namespace

Schema roll_controller_schema() {
  return add_course(object("Rolls along a course. For round bodies. At its end it stands."))
      .field("speed", number("Speed of travel.").unit("m/s").at_least(0).initially(1))
      .field("ramp_s",
             number("Time on the ground until that speed is asked for.").unit("s").above(0).initially(1))
      .field("effort",
             number("Weight of the centre-of-mass goals against the cost of changing the rest shape.")
                 .above(0)
                 .initially(3));
}

std::unique_ptr<Controller> make_roll_controller(const ControlledBody& body, const Value& settings) {
  return std::make_unique<RollController>(body, settings);
}

}  // namespace vivify::sim
