#include "sim/control/controllers/hop.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/control/rigid_motion.h"

namespace vivify::sim {
namespace {

constexpr double kHeightFrequency = 6;   // ω of the height goal, 1/s (k_p = ω k_d)
constexpr double kUprightFrequency = 8;  // wanted turning rate per radian of tilt, 1/s
constexpr double kSpinWeight = 10;       // of the spin goals, relative to the inertia of the body
constexpr double kLandingWeight = 0.3;   // a landing is caught softly
constexpr double kTouchLoad = 0.05;      // share of the weight that counts as standing on the ground
constexpr double kLongestFlight = 3;     // s; a body that never lands again starts over

enum Phase { kCrouch, kThrust, kFlight, kLand };
constexpr const char* kPhaseNames[] = {"crouch", "thrust", "flight", "land"};

double smooth_step(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

class HopController final : public Controller {
 public:
  HopController(const ControlledBody& body, const Value& settings)
      : body_(body),
        weight_(settings["effort"].as_number()),
        crouch_depth_(settings["crouch_depth"].as_number() * body.height),
        crouch_s_(settings["crouch_s"].as_number()),
        thrust_s_(settings["thrust_s"].as_number()),
        land_s_(settings["land_s"].as_number()) {
    const double heading = settings["heading_deg"].as_number() * std::numbers::pi / 180;
    forward_ = Eigen::Vector3d(std::sin(heading), 0, std::cos(heading));
    face_heading_ = settings["face_heading"].as_bool();
    heading_ = std::remainder(heading, 2 * std::numbers::pi);
    take_off_ = std::sqrt(2 * body.gravity * settings["height"].as_number());
    const double flight = 2 * take_off_ / body.gravity;
    // The body travels in flight, and with half the speed while it pushes off.
    const double cycle = crouch_s_ + 0.5 * thrust_s_ + flight + land_s_;
    speed_ = settings["pace"].as_number() * cycle / (flight + 0.25 * thrust_s_);
    rest_height_ = centre_of_mass(body.mass, body.rest).y();
  }

  std::vector<Goal> goals(const Observation& now) override {
    const Eigen::Vector3d centre = centre_of_mass(body_.mass, now.x);
    if (!started_) {
      started_ = true;
      enter(kCrouch, centre);
    }
    const bool standing = now.load > kTouchLoad * body_.mass.sum() * body_.gravity;
    advance_phase(standing, centre);
    time_ += body_.h;

    std::vector<Goal> goals;
    const double kd = std::sqrt(weight_ * body_.mass.sum());
    switch (phase_) {
      case kCrouch: {
        const double t = time_ / crouch_s_;
        const double ramp = smooth_step(t), rate = t < 1 ? 6 * t * (1 - t) / crouch_s_ : 0;
        const double target = start_.y() + (ground_height_ - crouch_depth_ - start_.y()) * ramp;
        add_centre(goals, Eigen::Vector3d::UnitY(), kd, kHeightFrequency, target,
                   (ground_height_ - crouch_depth_ - start_.y()) * rate);
        hold_place(goals, kd);
        add_upright(goals, now.x, 1);
        break;
      }
      case kThrust: {
        const double ramp = smooth_step(time_ / (0.5 * thrust_s_));
        add_centre(goals, Eigen::Vector3d::UnitY(), kd, 0, 0, ramp * take_off_);
        add_centre(goals, forward_, kd, 0, 0, ramp * speed_);
        add_centre(goals, sideways(), kd, 0, 0, 0);
        add_upright(goals, now.x, 1);
        break;
      }
      case kFlight:
        break;
      case kLand: {
        const double soft = std::sqrt(kLandingWeight) * kd;
        add_centre(goals, Eigen::Vector3d::UnitY(), soft, kHeightFrequency, ground_height_, 0);
        add_centre(goals, forward_, soft, 0, 0, 0);
        add_centre(goals, sideways(), soft, 0, 0, 0);
        add_upright(goals, now.x, kLandingWeight);
        break;
      }
    }
    return goals;
  }

  std::string phase() const override { return kPhaseNames[phase_]; }

  Eigen::VectorXd state() const override {
    Eigen::VectorXd state(7);
    state << started_, phase_, time_, start_.x(), start_.y(), start_.z(), ground_height_;
    return state;
  }

  void restore(const Eigen::VectorXd& state) override {
    started_ = state[0] != 0;
    phase_ = static_cast<Phase>(static_cast<int>(state[1]));
    time_ = state[2];
    start_ = state.segment<3>(3);
    ground_height_ = state[6];
  }

 private:
  Eigen::Vector3d sideways() const { return Eigen::Vector3d::UnitY().cross(forward_); }

  void enter(Phase phase, const Eigen::Vector3d& centre) {
    phase_ = phase;
    time_ = 0;
    start_ = centre;
    if (phase == kCrouch && ground_height_ == 0) ground_height_ = rest_height_;
  }

  void advance_phase(bool standing, const Eigen::Vector3d& centre) {
    switch (phase_) {
      case kCrouch:
        if (time_ >= crouch_s_) enter(kThrust, centre);
        break;
      case kThrust:
        if (!standing && time_ > body_.h) {
          enter(kFlight, centre);
        } else if (time_ >= 2 * thrust_s_) {
          enter(kLand, centre);  // did not leave the ground: try again
        }
        break;
      case kFlight:
        if (standing || time_ >= kLongestFlight) enter(kLand, centre);
        break;
      case kLand:
        if (time_ >= land_s_ && standing) enter(kCrouch, centre);
        break;
    }
  }

  void add_centre(std::vector<Goal>& goals, const Eigen::Vector3d& direction, double kd, double frequency,
                  double sx, double sv) const {
    goals.push_back({centre_of_mass_weights(body_.mass, direction), frequency * kd, kd, sx, sv});
  }

  void hold_place(std::vector<Goal>& goals, double kd) const {
    add_centre(goals, forward_, kd, 0, 0, 0);
    add_centre(goals, sideways(), kd, 0, 0, 0);
  }

  // Turns the body upright, and its face towards the heading when asked.
  void add_upright(std::vector<Goal>& goals, const Eigen::VectorXd& x, double scale) const {
    const Eigen::Matrix3d R = best_rotation(body_.mass, body_.rest, x);
    Eigen::Vector3d rate = kUprightFrequency * (R * Eigen::Vector3d::UnitY()).cross(Eigen::Vector3d::UnitY());
    const Eigen::Vector3d front = R * Eigen::Vector3d::UnitZ();
    const double yaw = std::atan2(front.x(), front.z());
    const double wanted = face_heading_ ? heading_ : 0;
    rate.y() = std::clamp(kUprightFrequency * std::remainder(wanted - yaw, 2 * std::numbers::pi), -2.0, 2.0);
    const double inertia = inertia_tensor(body_.mass, x).trace() / 3;
    const double kd = std::sqrt(scale * kSpinWeight * inertia);
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d direction = Eigen::Vector3d::Unit(axis);
      goals.push_back({spin_weights(body_.mass, x, direction), 0, kd, 0, rate[axis]});
    }
  }

  ControlledBody body_;
  double weight_, crouch_depth_, crouch_s_, thrust_s_, land_s_;
  Eigen::Vector3d forward_;
  bool face_heading_ = false;
  double heading_ = 0, take_off_ = 0, speed_ = 0, rest_height_ = 0;

  bool started_ = false;
  Phase phase_ = kCrouch;
  double time_ = 0;                                  // since the phase began, s
  Eigen::Vector3d start_ = Eigen::Vector3d::Zero();  // centre of mass when the phase began, m
  double ground_height_ = 0;                         // of the centre of mass when standing, m
};

}  // namespace

Schema hop_controller_schema() {
  return object("Hops along a heading: crouch, thrust, flight, land.")
      .field("heading_deg", number("Direction of travel: 0 is +z, 90 is +x.").unit("°").initially(0))
      .field("height",
             number("Rise of the centre of mass after take-off.").unit("m").above(0).initially(0.25))
      .field("pace", number("Average forward speed.").unit("m/s").at_least(0).initially(0.6))
      .field("face_heading",
             boolean("Turn the front of the character (+z at rest) towards the heading.").initially(false))
      .field("crouch_depth", number("Depth of the crouch as a share of the body's height.")
                                 .at_least(0)
                                 .at_most(0.5)
                                 .initially(0.12))
      .field("crouch_s", number("Duration of the crouch.").unit("s").above(0).initially(0.25))
      .field("thrust_s", number("Time to push off; the thrust ends when the body leaves the ground.")
                             .unit("s")
                             .above(0)
                             .initially(0.15))
      .field("land_s", number("Time to recover after touch-down.").unit("s").above(0).initially(0.25))
      .field("effort",
             number("Weight of the centre-of-mass goals against the cost of changing the rest shape.")
                 .above(0)
                 .initially(1));
}

std::unique_ptr<Controller> make_hop_controller(const ControlledBody& body, const Value& settings) {
  return std::make_unique<HopController>(body, settings);
}

}  // namespace vivify::sim
