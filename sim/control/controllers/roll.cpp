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
constexpr double kSlow = 0.2;          // of the wanted speed: nearly standing

class RollController final : public Controller {
 public:
  RollController(const ControlledBody& body, const Value& settings)
      : body_(body),
        course_(body, settings),
        speed_(settings["speed"].as_number()),
        ramp_s_(settings["ramp_s"].as_number()),
        weight_(settings["effort"].as_number()),
        rest_rise_(centre_of_mass(body.mass, body.rest).y() - lowest_height(body.rest, body.dimension())) {}

  std::vector<Goal> goals(const Observation& now) override {
    rolling_ = stands(body_, now.load);
    if (!rolling_) return {};  // in the air no internal force moves the centre of mass
    time_ += body_.h;
    const Eigen::Vector3d centre = centre_of_mass(body_.mass, now.x), v = centre_of_mass(body_.mass, now.v);
    const Course::Way way = course_.way(centre, body_.height, now.others);
    if (course_.ends(way) && v.norm() < kSlow * speed_) arrived_ = true;
    const double wanted =
        arrived_ ? 0 : std::min(speed_ * std::min(1.0, time_ / ramp_s_), last_speed(way.left));
    // Goals are tracked with a bias (they are weighed against the regulariser): ask for more where it falls
    // short.
    learnt_ += kLearning * body_.h * (wanted - way.forward.dot(v));
    learnt_ = std::clamp(learnt_, -kLargestLearnt * wanted, kLargestLearnt * wanted);
    const double steer =
        std::clamp(-kLineFrequency * way.offset, -kLargestSteer * speed_, kLargestSteer * speed_);
    const double ground = lowest_height(now.x, body_.dimension());
    BodyGoals goals(body_, now.x);
    goals.centre(way.forward, weight_, 0, 0, wanted + learnt_);
    goals.centre(Eigen::Vector3d::UnitY().cross(way.forward), weight_, 0, 0, steer);
    goals.centre(Eigen::Vector3d::UnitY(), kHeightWeight * weight_, kHeightFrequency, ground + rest_rise_, 0);
    return goals.take();
  }

  bool arrived() const override { return arrived_; }
  std::string phase() const override { return !rolling_ ? "flight" : arrived_ ? "stand" : "roll"; }

  Eigen::VectorXd state() const override {
    Eigen::VectorXd state(4 + Course::kStateSize);
    state << rolling_, time_, learnt_, arrived_, course_.state();
    return state;
  }
  void restore(const Eigen::VectorXd& state) override {
    rolling_ = state[0] != 0;
    time_ = state[1];
    learnt_ = state[2];
    arrived_ = state[3] != 0;
    course_.restore(state.tail<Course::kStateSize>());
  }

 private:
  // From which it comes to a stand within `left` when it slows down as fast as it speeds up.
  double last_speed(double left) const { return std::sqrt(2 * speed_ / ramp_s_ * left); }

  ControlledBody body_;
  Course course_;
  double speed_, ramp_s_, weight_;
  double rest_rise_;  // of the centre of mass above the lowest vertex at rest, m

  bool rolling_ = false, arrived_ = false;
  double time_ = 0;    // spent on the ground, s
  double learnt_ = 0;  // added to the speed that is asked for, m/s
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
