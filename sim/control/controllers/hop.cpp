#include "sim/control/controllers/hop.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sim/control/heading.h"
#include "sim/control/rigid_motion.h"

namespace vivify::sim {
namespace {

constexpr double kHeightFrequency = 6;   // ω of the height goal, 1/s (k_p = ω k_d)
constexpr double kUprightFrequency = 8;  // wanted turning rate per radian of tilt, 1/s
constexpr double kSoftWeight = 0.3;      // of landing and crouching, relative to the thrust
constexpr double kTouchLoad = 0.05;      // share of the weight that counts as standing on the ground
constexpr double kFall = 0.6;            // largest downward acceleration of a crouch, in g
constexpr double kLongestCrouch = 2;     // of the asked duration
constexpr double kLearning = 0.5;  // share of a missed take-off velocity that the next thrust asks for on top
constexpr double kLargestLearnt = 0.5;  // of the wanted take-off velocity
constexpr double kLineGain = 0.5;       // share of a sideways offset that one flight takes back
constexpr double kLargestSteer = 0.3;   // sideways take-off speed, of the upward one
constexpr double kLongestFlight = 3;    // s; a body that never lands again starts over

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
        land_s_(settings["land_s"].as_number()),
        upright_(settings["upright"].as_number()) {
    forward_ = heading_of(body, settings);
    face_heading_ = settings["face_heading"].as_bool();
    heading_ = std::atan2(forward_.x(), forward_.z());
    take_off_ = std::sqrt(2 * body.gravity * settings["height"].as_number());
    const double flight = 2 * take_off_ / body.gravity;
    // The body travels in flight, and with half the speed while it pushes off.
    const double cycle = crouch_s_ + 0.5 * thrust_s_ + flight + land_s_;
    speed_ = settings["pace"].as_number() * cycle / (flight + 0.25 * thrust_s_);
    rest_centre_ = centre_of_mass(body.mass, body.rest);
    rest_rise_ = rest_centre_.y() - lowest_height(body.rest, body.dimension());
    time_ = land_s_;
  }

  std::vector<Goal> goals(const Observation& now) override {
    const bool standing = now.load > kTouchLoad * body_.mass.sum() * body_.gravity;
    if (now.ground) ground_ = *now.ground;
    advance_phase(standing, now);
    time_ += body_.h;
    carried_ += body_.h * ground_;

    std::vector<Goal> goals;
    if (!standing && phase_ != kThrust)
      return goals;  // in the air no internal force moves the centre of mass
    const double kd = std::sqrt(weight_ * body_.mass.sum()), soft = std::sqrt(kSoftWeight) * kd;
    switch (phase_) {
      case kCrouch: {
        const auto [height, rate] = crouch_path();
        add_centre(goals, up(), soft, kHeightFrequency, height, rate);
        add_centre(goals, forward_, soft, 0, 0, 0);
        add_centre(goals, sideways(), soft, 0, 0, 0);
        add_upright(goals, now.x, kSoftWeight);
        break;
      }
      case kThrust: {
        const double ramp = smooth_step(time_ / (0.5 * thrust_s_));
        const Eigen::Vector3d asked = ramp * (wanted_take_off() + learnt_);
        for (const Eigen::Vector3d& direction : {up(), forward_, sideways()}) {
          add_centre(goals, direction, kd, 0, 0, direction.dot(asked));
        }
        add_upright(goals, now.x, 1);
        break;
      }
      case kFlight:
        break;
      case kLand: {
        add_centre(goals, up(), soft, kHeightFrequency, ground_height_, 0);
        add_centre(goals, forward_, soft, 0, 0, 0);
        add_centre(goals, sideways(), soft, 0, 0, 0);
        add_upright(goals, now.x, kSoftWeight);
        break;
      }
    }
    return goals;
  }

  std::string phase() const override { return kPhaseNames[phase_]; }

  Eigen::VectorXd state() const override {
    Eigen::VectorXd state(16);
    state << phase_, time_, start_, start_rate_, ground_height_, learnt_, ground_, carried_;
    return state;
  }

  void restore(const Eigen::VectorXd& state) override {
    phase_ = static_cast<Phase>(static_cast<int>(state[0]));
    time_ = state[1];
    start_ = state.segment<3>(2);
    start_rate_ = state[5];
    ground_height_ = state[6];
    learnt_ = state.segment<3>(7);
    ground_ = state.segment<3>(10);
    carried_ = state.segment<3>(13);
  }

 private:
  static Eigen::Vector3d up() { return Eigen::Vector3d::UnitY(); }
  Eigen::Vector3d sideways() const { return up().cross(forward_); }

  // Velocity of the centre of mass over the ground at take-off: the asked height and pace, and back to the
  // line of travel.
  Eigen::Vector3d wanted_take_off() const {
    const double flight = 2 * take_off_ / body_.gravity;
    const double offset = sideways().dot(start_ - rest_centre_);
    const double back =
        std::clamp(-kLineGain * offset / flight, -kLargestSteer * take_off_, kLargestSteer * take_off_);
    return take_off_ * up() + speed_ * forward_ + back * sideways();
  }

  // Goals are tracked with a bias (they are weighed against the regulariser): ask for more where the last
  // take-off fell short.
  void learn(const Observation& now) {
    const Eigen::Vector3d missed = wanted_take_off() + ground_ - centre_of_mass(body_.mass, now.v);
    learnt_ += kLearning * missed;
    const double largest = kLargestLearnt * wanted_take_off().norm();
    if (learnt_.norm() > largest) learnt_ *= largest / learnt_.norm();
  }

  // Wanted height of the centre of mass and its rate: the cubic from where the crouch began, with the
  // velocity it had, to rest at the bottom.
  std::pair<double, double> crouch_path() const {
    const double duration = crouch_duration(), t = std::min(1.0, time_ / duration);
    const double bottom = ground_height_ - crouch_depth_;
    const double a = start_.y() - bottom, b = start_rate_ * duration;
    const double height = bottom + a * (1 - t * t * (3 - 2 * t)) + b * t * (1 - t) * (1 - t);
    const double rate = (-6 * a * t * (1 - t) + b * (1 - t) * (1 - 3 * t)) / duration;
    return {height, rate};
  }

  // At least the asked duration, and long enough that the path never falls so fast that the feet would lift:
  // its acceleration at the start, −(6 a/T² + 4 v/T), stays above −kFall g.
  double crouch_duration() const {
    const double a = std::max(0.0, start_.y() - ground_height_ + crouch_depth_), v = start_rate_;
    const double fall = kFall * body_.gravity;
    const double slowest = (2 * v + std::sqrt(4 * v * v + 6 * a * fall)) / fall;
    return std::max(crouch_s_, std::min(slowest, kLongestCrouch * crouch_s_));
  }

  void enter(Phase phase, const Observation& now) {
    phase_ = phase;
    time_ = 0;
    start_ = centre_of_mass(body_.mass, now.x) - carried_;
    start_rate_ = centre_of_mass(body_.mass, now.v).y() - ground_.y();
    // The ground may be anywhere: the centre stands above the lowest vertex as it does at rest.
    if (phase == kCrouch || phase == kLand)
      ground_height_ = lowest_height(now.x, body_.dimension()) + rest_rise_ - carried_.y();
  }

  void advance_phase(bool standing, const Observation& now) {
    switch (phase_) {
      case kCrouch:
        if (time_ >= crouch_duration()) enter(kThrust, now);
        break;
      case kThrust:
        if (!standing && time_ > body_.h) {
          learn(now);
          enter(kFlight, now);
        } else if (time_ >= 2 * thrust_s_) {
          enter(kLand, now);  // did not leave the ground: try again
        }
        break;
      case kFlight:
        if (standing || time_ >= kLongestFlight) enter(kLand, now);
        break;
      case kLand:
        if (time_ >= land_s_ && standing) enter(kCrouch, now);
        break;
    }
  }

  // sx and sv are of a frame that goes along with the ground.
  void add_centre(std::vector<Goal>& goals, const Eigen::Vector3d& direction, double kd, double frequency,
                  double sx, double sv) const {
    goals.push_back({centre_of_mass_weights(body_.mass, direction, body_.dimension()), frequency * kd, kd,
                     sx + direction.dot(carried_), sv + direction.dot(ground_)});
  }

  // Turns the body upright, and its face towards the heading when asked.
  void add_upright(std::vector<Goal>& goals, const Eigen::VectorXd& x, double scale) const {
    if (upright_ == 0) return;
    const Eigen::Matrix3d R = best_rotation(body_.mass, body_.rest, x);
    Eigen::Vector3d rate = kUprightFrequency * (R * Eigen::Vector3d::UnitY()).cross(Eigen::Vector3d::UnitY());
    const Eigen::Vector3d front = R * Eigen::Vector3d::UnitZ();
    const double yaw = std::atan2(front.x(), front.z());
    const double wanted = face_heading_ ? heading_ : 0;
    rate.y() = std::clamp(kUprightFrequency * std::remainder(wanted - yaw, 2 * std::numbers::pi), -2.0, 2.0);
    const Eigen::Matrix3d inertia = inertia_tensor(body_.mass, x);
    const bool planar = body_.dimension() == 2;
    const double kd = std::sqrt(scale * upright_ * (planar ? inertia(2, 2) : inertia.trace() / 3));
    for (int axis = planar ? 2 : 0; axis < 3; ++axis) {
      const Eigen::Vector3d direction = Eigen::Vector3d::Unit(axis);
      goals.push_back({spin_weights(body_.mass, x, direction), 0, kd, 0, rate[axis]});
    }
  }

  ControlledBody body_;
  double weight_, crouch_depth_, crouch_s_, thrust_s_, land_s_, upright_;
  Eigen::Vector3d forward_;
  bool face_heading_ = false;
  double heading_ = 0, take_off_ = 0, speed_ = 0;
  Eigen::Vector3d rest_centre_;
  double rest_rise_ = 0;  // of the centre of mass above the lowest vertex at rest, m

  Phase phase_ = kLand;  // a body may start in the air; one that stands crouches at once
  double time_ = 0;      // since the phase began, s
  Eigen::Vector3d start_ = Eigen::Vector3d::Zero();   // centre of mass when the phase began, m
  double start_rate_ = 0;                             // its vertical velocity then, over the ground, m/s
  Eigen::Vector3d learnt_ = Eigen::Vector3d::Zero();  // added to the take-off velocity, m/s
  double ground_height_ = 0;                          // of the centre of mass when standing, m
  // Velocity of the ground when it was touched last (m/s), and how far it would have gone with it (m). Places
  // are kept without the latter.
  Eigen::Vector3d ground_ = Eigen::Vector3d::Zero(), carried_ = Eigen::Vector3d::Zero();
};

}  // namespace

Schema hop_controller_schema() {
  return object("Hops along a heading: crouch, thrust, flight, land.")
      .field("heading_deg", heading_schema())
      .field("height",
             number("Rise of the centre of mass after take-off.").unit("m").above(0).initially(0.25))
      .field("pace", number("Average forward speed.").unit("m/s").at_least(0).initially(0.6))
      .field("face_heading",
             boolean("Turn the front of the character (+z at rest) towards the heading.").initially(false))
      .field("crouch_depth", number("Depth of the crouch as a share of the body's height.")
                                 .at_least(0)
                                 .at_most(0.5)
                                 .initially(0.1))
      .field("crouch_s", number("Duration of the crouch.").unit("s").above(0).initially(0.25))
      .field("thrust_s", number("Time to push off; the thrust ends when the body leaves the ground.")
                             .unit("s")
                             .above(0)
                             .initially(0.15))
      .field("land_s", number("Time to recover after touch-down.").unit("s").above(0).initially(0.2))
      .field("effort",
             number("Weight of the centre-of-mass goals against the cost of changing the rest shape.")
                 .above(0)
                 .initially(1))
      .field("upright", number("Weight of the goals that turn the body upright, relative to its inertia; 0 "
                               "leaves the centre of mass as the only goal.")
                            .at_least(0)
                            .initially(10));
}

std::unique_ptr<Controller> make_hop_controller(const ControlledBody& body, const Value& settings) {
  return std::make_unique<HopController>(body, settings);
}

}  // namespace vivify::sim
