#include "sim/control/controllers/roll.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "sim/control/heading.h"
#include "sim/control/rigid_motion.h"

namespace vivify::sim {
namespace {

constexpr double kHeightFrequency = 6;  // ω of the height goal, 1/s (k_p = ω k_d)
constexpr double kHeightWeight = 0.1;   // of the height goal, relative to that of the speed
constexpr double kTouchLoad = 0.05;     // share of the weight that counts as standing on the ground
constexpr double kLearning = 0.5;  // share of a missing speed that a second of rolling adds to what is asked
constexpr double kLargestLearnt = 1;   // of the wanted speed
constexpr double kLineFrequency = 1;   // share of a sideways offset that a second of rolling takes back
constexpr double kLargestSteer = 0.3;  // sideways speed, of the wanted one

class RollController final : public Controller {
 public:
  RollController(const ControlledBody& body, const Value& settings)
      : body_(body),
        forward_(heading_of(body, settings)),
        speed_(settings["speed"].as_number()),
        ramp_s_(settings["ramp_s"].as_number()),
        weight_(settings["effort"].as_number()),
        rest_centre_(centre_of_mass(body.mass, body.rest)),
        rest_rise_(rest_centre_.y() - lowest_height(body.rest, body.dimension())) {}

  std::vector<Goal> goals(const Observation& now) override {
    rolling_ = now.load > kTouchLoad * body_.mass.sum() * body_.gravity;
    if (!rolling_) return {};  // in the air no internal force moves the centre of mass
    time_ += body_.h;
    const double wanted = speed_ * std::min(1.0, time_ / ramp_s_);
    const Eigen::Vector3d centre = centre_of_mass(body_.mass, now.x);
    // Goals are tracked with a bias (they are weighed against the regulariser): ask for more where it falls
    // short.
    learnt_ += kLearning * body_.h * (wanted - forward_.dot(centre_of_mass(body_.mass, now.v)));
    learnt_ = std::clamp(learnt_, -kLargestLearnt * speed_, kLargestLearnt * speed_);
    const double steer = std::clamp(-kLineFrequency * sideways().dot(centre - rest_centre_),
                                    -kLargestSteer * speed_, kLargestSteer * speed_);
    const double ground = lowest_height(now.x, body_.dimension());
    const double kd = std::sqrt(weight_ * body_.mass.sum()), slight = std::sqrt(kHeightWeight) * kd;
    return {{along(forward_), 0, kd, 0, wanted + learnt_},
            {along(sideways()), 0, kd, 0, steer},
            {along(up()), kHeightFrequency * slight, slight, ground + rest_rise_, 0}};
  }

  std::string phase() const override { return rolling_ ? "roll" : "flight"; }

  Eigen::VectorXd state() const override { return Eigen::Vector3d(rolling_, time_, learnt_); }
  void restore(const Eigen::VectorXd& state) override {
    rolling_ = state[0] != 0;
    time_ = state[1];
    learnt_ = state[2];
  }

 private:
  static Eigen::Vector3d up() { return Eigen::Vector3d::UnitY(); }
  Eigen::Vector3d sideways() const { return up().cross(forward_); }
  Eigen::VectorXd along(const Eigen::Vector3d& direction) const {
    return centre_of_mass_weights(body_.mass, direction, body_.dimension());
  }

  ControlledBody body_;
  Eigen::Vector3d forward_;
  double speed_, ramp_s_, weight_;
  Eigen::Vector3d rest_centre_;
  double rest_rise_;  // of the centre of mass above the lowest vertex at rest, m

  bool rolling_ = false;
  double time_ = 0;    // spent on the ground, s
  double learnt_ = 0;  // added to the speed that is asked for, m/s
};

}  // namespace

Schema roll_controller_schema() {
  return object("Rolls along a heading. For round bodies.")
      .field("heading_deg", heading_schema())
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
