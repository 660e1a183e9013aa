#include "sim/control/controllers/hop.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "sim/control/body_goals.h"
#include "sim/control/course.h"
#include "sim/control/rigid_motion.h"

namespace vivify::sim {
namespace {

constexpr double kHeightFrequency = 6;   // ω of the height goal, 1/s (k_p = ω k_d)
constexpr double kUprightFrequency = 8;  // wanted turning rate per radian of tilt, 1/s
constexpr double kSoftWeight = 0.3;      // of landing and crouching, relative to the thrust
constexpr double kFall = 0.6;            // largest downward acceleration of a crouch, in g
constexpr double kLongestCrouch = 2;     // of the asked duration
constexpr double kLearning = 0.5;  // share of a missed take-off velocity that the next thrust asks for on top
constexpr double kLargestLearnt = 0.5;    // of the wanted take-off velocity
constexpr double kLineGain = 0.5;         // share of a sideways offset that one flight takes back
constexpr double kLargestSteer = 0.3;     // sideways take-off speed, of the upward one
constexpr double kLongestFlight = 3;      // s; a body that never lands again starts over
constexpr double kTurnOnGround = 2;       // largest turning rate about the vertical while it stands, 1/s
constexpr double kLargestLeanBack = 0.3;  // tangent of the angle at which it lands
constexpr double kExtra = 0.2;            // of a hop: a rest of the way so short lengthens the others

enum Phase { kCrouch, kThrust, kFlight, kLand };
constexpr const char* kPhaseNames[] = {"crouch", "thrust", "flight", "land"};

class HopController final : public Controller {
 public:
  HopController(const ControlledBody& body, const Value& settings)
      : body_(body),
        course_(body, settings),
        count_(settings.has("count") ? settings["count"].as_integer() : std::numeric_limits<long>::max()),
        weight_(settings["effort"].as_number()),
        crouch_depth_(settings["crouch_depth"].as_number() * body.height),
        crouch_s_(settings["crouch_s"].as_number()),
        thrust_s_(settings["thrust_s"].as_number()),
        land_s_(settings["land_s"].as_number()),
        upright_(settings["upright"].as_number()),
        turn_(settings["turn_deg"].as_number() * std::numbers::pi / 180),
        sway_(settings["sway_deg"].as_number() * std::numbers::pi / 180),
        feet_ahead_(settings["feet_ahead"].as_number()),
        face_heading_(settings["face_heading"].as_bool()),
        take_off_(std::sqrt(2 * body.gravity * settings["height"].as_number())),
        flight_s_(2 * take_off_ / body.gravity) {
    // The body travels in flight, and with half the speed while it pushes off.
    stride_ = settings["pace"].as_number() * (crouch_s_ + 0.5 * thrust_s_ + flight_s_ + land_s_);
    rest_rise_ = rest_rise(body);
    time_ = land_s_;
  }

  std::vector<Goal> goals(const Observation& now) override {
    const bool standing = stands(body_, now.load);
    const Eigen::Matrix3d R = best_rotation(body_.mass, body_.rest, now.x);
    if (now.ground) ground_ = *now.ground;
    if (!begun_) {
      begun_ = true;
      yaw_ = yaw_of(R);
      way_ = course_.way(centre_of_mass(body_.mass, now.x), stride_, now.others);
    }
    advance_phase(standing, now);
    time_ += body_.h;
    carried_ += body_.h * ground_;
    if (!standing && phase_ != kThrust) return {};  // in the air no internal force moves the centre of mass

    BodyGoals goals(body_, now.x);
    Eigen::Vector3d rate = kUprightFrequency * (R * up()).cross(head());
    if (!planar()) rate.y() = yaw_rate(R);
    switch (phase_) {
      case kCrouch: {
        const auto [height, fall] = crouch_path();
        add_centre(goals, kSoftWeight, kHeightFrequency, height, Eigen::Vector3d(0, fall, 0));
        goals.spin(kSoftWeight * upright_, rate);
        break;
      }
      case kThrust: {
        const double ramp = smooth_step(time_ / (0.5 * thrust_s_));
        if (feet_ahead_ > 0) turn_to_landing(rate, ramp, R, now);
        if (turn_ != 0 && !planar()) rate.y() = ramp * turn_ / flight_s_;
        if (sway_ != 0) rate += (ramp * roll_rate(R) - rate.dot(way_.forward)) * way_.forward;
        add_centre(goals, 1, 0, 0, ramp * (wanted_take_off() + asked_on_top()));
        goals.spin(upright_, rate);
        break;
      }
      case kFlight:
        break;
      case kLand: {
        add_centre(goals, kSoftWeight, kHeightFrequency, ground_height_, Eigen::Vector3d::Zero());
        goals.spin(kSoftWeight * upright_, rate);
        break;
      }
    }
    return goals.take();
  }

  bool arrived() const override { return arrived_; }

  std::string phase() const override { return kPhaseNames[phase_]; }

  Eigen::VectorXd state() const override {
    Eigen::VectorXd state(25 + Course::kStateSize);
    state << phase_, time_, start_, start_rate_, ground_height_, learnt_, ground_, carried_, begun_, arrived_,
        hops_, yaw_, way_.forward, way_.offset, way_.left, course_.state();
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
    begun_ = state[16] != 0;
    arrived_ = state[17] != 0;
    hops_ = static_cast<long>(state[18]);
    yaw_ = state[19];
    way_ = {state.segment<3>(20), state[23], state[24]};
    course_.restore(state.tail<Course::kStateSize>());
  }

 private:
  bool planar() const { return body_.dimension() == 2; }
  static Eigen::Vector3d up() { return Eigen::Vector3d::UnitY(); }
  Eigen::Vector3d sideways() const { return up().cross(way_.forward); }

  // Angle from the vertical to the left: to one side and the other, from hop to hop.
  double lean() const { return arrived_ ? 0 : hops_ % 2 == 0 ? sway_ : -sway_; }
  // Where the head of the body shall be, from its centre.
  Eigen::Vector3d head() const { return (up() + std::tan(lean()) * sideways()).normalized(); }
  // Turning rate about the line of travel with which a flight leads over to the other side.
  double roll_rate(const Eigen::Matrix3d& R) const {
    return (lean() + std::asin(std::clamp((R * up()).dot(sideways()), -1.0, 1.0))) / flight_s_;
  }

  // The level part of `rate` becomes the one with which the flight leads to where the feet are ahead of the
  // centre of mass, by a share of its capture point v √(z/g): they can take up its speed there (Raibert
  // 1986).
  void turn_to_landing(Eigen::Vector3d& rate, double ramp, const Eigen::Matrix3d& R,
                       const Observation& now) const {
    Eigen::Vector3d back = ground_ - centre_of_mass(body_.mass, now.v);
    back.y() = 0;
    back *= feet_ahead_ / std::sqrt(body_.gravity * rest_rise_);
    if (back.norm() > kLargestLeanBack) back *= kLargestLeanBack / back.norm();
    const double about_vertical = rate.y();
    rate = ramp / flight_s_ * (R * up()).cross((head() + back).normalized());
    if (!planar()) rate.y() = about_vertical;
  }

  // Velocity of the centre of mass over the ground at take-off: the asked height and pace, in equal hops to
  // where the way ends, and back to the line of travel.
  Eigen::Vector3d wanted_take_off() const {
    const double back = std::clamp(-kLineGain * way_.offset / flight_s_, -kLargestSteer * take_off_,
                                   kLargestSteer * take_off_);
    const double speed = hop_share() * stride_ / (flight_s_ + 0.25 * thrust_s_);
    return take_off_ * up() + speed * way_.forward + back * sideways();
  }

  // Length of the next hop over the usual one.
  double hop_share() const {
    const double hops = stride_ > 0 ? way_.left / stride_ : std::numeric_limits<double>::infinity();
    return std::isfinite(hops) ? hops / std::max(1.0, std::ceil(hops - kExtra)) : 1;
  }

  // What a hop falls short grows with its length.
  Eigen::Vector3d asked_on_top() const {
    const double share = hop_share();
    return {share * learnt_.x(), learnt_.y(), share * learnt_.z()};
  }

  // Turns towards where the body shall look.
  double yaw_rate(const Eigen::Matrix3d& R) const {
    const double wanted = face_heading_ ? std::atan2(way_.forward.x(), way_.forward.z()) : yaw_;
    return std::clamp(kUprightFrequency * nearest_turn(wanted - yaw_of(R)), -kTurnOnGround, kTurnOnGround);
  }

  // Goals are tracked with a bias (they are weighed against the regulariser): ask for more where the last
  // take-off fell short.
  void learn(const Observation& now) {
    const Eigen::Vector3d missed = wanted_take_off() + ground_ - centre_of_mass(body_.mass, now.v);
    learnt_ += kLearning * hop_share() * missed;
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
    // One that has arrived keeps its direction until it is moved away.
    const Eigen::Vector3d forward = way_.forward;
    way_ = course_.way(start_, stride_, now.others);
    if (arrived_ && course_.ends(way_)) way_.forward = forward;
    // The ground may be anywhere: the centre stands above the lowest vertex as it does at rest.
    if (phase == kCrouch || phase == kLand)
      ground_height_ = lowest_height(now.x, body_.dimension()) + rest_rise_ - carried_.y();
  }

  void rest_or_go_on(const Observation& now) {
    const bool rests = hops_ >= count_ || (hops_ > 0 && course_.ends(way_));
    arrived_ = arrived_ || rests;
    enter(rests ? kLand : kCrouch, now);
  }

  void advance_phase(bool standing, const Observation& now) {
    switch (phase_) {
      case kCrouch:
        if (time_ >= crouch_duration()) enter(kThrust, now);
        break;
      case kThrust:
        if (!standing && time_ > body_.h) {
          learn(now);
          yaw_ += turn_;
          ++hops_;
          enter(kFlight, now);
        } else if (time_ >= 2 * thrust_s_) {
          enter(kLand, now);  // did not leave the ground: try again
        }
        break;
      case kFlight:
        if (standing || time_ >= kLongestFlight) enter(kLand, now);
        break;
      case kLand:
        if (time_ >= land_s_ && standing) rest_or_go_on(now);
        break;
    }
  }

  // Height and velocity are of a frame that goes along with the ground.
  void add_centre(BodyGoals& goals, double weight, double frequency, double height,
                  const Eigen::Vector3d& velocity) const {
    for (const Eigen::Vector3d& direction : {up(), way_.forward, sideways()}) {
      const bool upward = direction.y() != 0;
      goals.centre(direction, weight_ * weight, upward ? frequency : 0, upward ? height + carried_.y() : 0,
                   direction.dot(velocity + ground_));
    }
  }

  ControlledBody body_;
  Course course_;
  long count_;
  double weight_, crouch_depth_, crouch_s_, thrust_s_, land_s_, upright_, turn_, sway_, feet_ahead_;
  bool face_heading_;
  double take_off_, flight_s_;
  double stride_ = 0;     // length of a hop, m
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
  bool begun_ = false, arrived_ = false;
  long hops_ = 0;
  double yaw_ = 0;  // where it looks while it stands, when it does not face its way
  Course::Way way_ = {Eigen::Vector3d::UnitX(), 0, 0};  // when the phase began
};

}  // namespace

Schema hop_controller_schema() {
  return add_course(object("Hops along a course: crouch, thrust, flight, land. At its end, and after `count` "
                           "hops, it stands."))
      .field("count", integer("Number of hops; without it there is no end.").at_least(1))
      .field("height",
             number("Rise of the centre of mass after take-off.").unit("m").above(0).initially(0.25))
      .field("pace", number("Average forward speed.").unit("m/s").at_least(0).initially(0.6))
      .field("face_heading",
             boolean("Turn the front of the character (+z at rest) towards the heading.").initially(false))
      .field("turn_deg",
             number("Turn about the vertical during each hop, to the left.").unit("°").initially(0))
      .field(
          "sway_deg",
          number("How far the body leans to one side and the other, from hop to hop.").unit("°").initially(0))
      .field(
          "feet_ahead",
          number("Share of the capture point by which the feet land ahead of the centre of mass, and take up "
                 "its speed; at 0 the thrust turns the body upright instead. Helps where a base is short.")
              .at_least(0)
              .at_most(1)
              .initially(0))
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
