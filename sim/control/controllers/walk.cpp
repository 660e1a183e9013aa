#include "sim/control/controllers/walk.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>

#include "sim/control/body_goals.h"
#include "sim/control/course.h"
#include "sim/control/foot.h"
#include "sim/control/rigid_motion.h"
#include "sim/control/walking_balance.h"
#include "sim/region.h"

namespace vivify::sim {
namespace {

// Frequencies are in units of √(g / L), speeds of √(g L), with the height L of the body.
constexpr double kHeightFrequency = 2.5;      // of the centre of mass about its wanted height
constexpr double kUprightFrequency = 2.5;     // wanted turning rate per radian of tilt
constexpr double kSwingFrequency = 5;         // k_p over k_d of a foot on its way
constexpr double kStanceFrequency = 1.5;      // of a foot that stays
constexpr double kSinking = 0.1;              // speed of a foot that feels for the ground
constexpr double kLargestLearnt = 0.5;        // speed that is asked for on top
constexpr double kFootEffort = 2;             // weight of the goals of a foot
constexpr double kFall = 0.3;                 // largest wanted acceleration downwards, g
constexpr double kRise = 0.5;                 // and upwards
constexpr double kEarliestLanding = 0.6;      // share of a step after which its foot may have landed
constexpr double kLatestLanding = 3;          // after which it is taken for landed
constexpr double kLongestShift = 5;           // after which another foot steps
constexpr double kShortest = 0.05;            // of the height: steps that are not worth taking
constexpr double kShortestAtEnd = 0.15;       // where the way ends
constexpr double kShortestShareAtEnd = 0.42;  // of a whole one there
constexpr double kLineGain = 0.5;             // share of a sideways offset that a step takes back
constexpr double kLargestTurn = 0.3;          // of a step, radians
constexpr double kTurnFrequency = 4;          // wanted turning rate about the vertical per radian, 1/s
constexpr double kLargestTurningRate = 1.5;   // 1/s

constexpr const char* kPhaseNames[] = {"stand", "shift", "swing"};  // by Stance::Phase

Eigen::Vector3d level(const Eigen::Vector3d& v) { return {v.x(), 0, v.z()}; }

class WalkController final : public Controller {
 public:
  WalkController(const ControlledBody& body, const Value& settings)
      : body_(body),
        course_(body, settings),
        pace_(settings["speed"].as_number()),
        step_(settings["step"].as_number() * body.height),
        lift_(settings["lift"].as_number() * body.height),
        swing_s_(settings["swing_s"].as_number()),
        sway_(settings["sway_deg"].as_number() * std::numbers::pi / 180),
        weight_(settings["effort"].as_number()),
        upright_(settings["upright"].as_number()),
        face_heading_(settings["face_heading"].as_bool() && body.dimension() == 3),
        balance_(make_walking_balance(body.dimension() == 2)),
        frequency_(std::sqrt(body.gravity / body.height)),
        speed_(std::sqrt(body.gravity * body.height)) {
    rest_rise_ = rest_rise(body);
    std::vector<Region> regions;
    for (const Value& foot : settings["feet"].items()) {
      regions.push_back(region_between(foot, "feet[" + std::to_string(regions.size()) + "]", foot.where()));
    }
    const RowMatrixXd V = Eigen::Map<const RowMatrixXd>(body.rest.data(), body.mass.size(), body.dimension());
    for (std::vector<int>& vertices : held_vertices(regions, V))
      feet_.emplace_back(body, std::move(vertices));
    held_.resize(feet_.size());
    loaded_.resize(feet_.size());
    lowest_.resize(feet_.size());
  }

  std::vector<Goal> goals(const Observation& now) override {
    look(now);
    advance(now);
    time_ += body_.h;
    since_step_ += body_.h;

    BodyGoals goals(body_, now.x);
    if (stands(body_, now.load)) {
      // Goals are tracked with a bias (they are weighed against the regulariser): ask for more where the last
      // step fell short.
      const double largest = kLargestLearnt * speed_;
      learnt_ *= std::exp(-body_.h * balance_->forgetting());
      learnt_ = (learnt_ + asked_ - velocity_).cwiseMax(-largest).cwiseMin(largest);
      asked_ = velocity_ + body_.h * wanted_acceleration();
      for (int axis = 0; axis < 3; ++axis) {
        goals.centre(Eigen::Vector3d::Unit(axis), weight_, 0, 0, asked_[axis] + learnt_[axis]);
      }
    } else {  // in the air no internal force moves the centre of mass
      learnt_.setZero();
      asked_ = velocity_;
    }
    goals.spin(upright_, turning_rate());
    std::vector<Goal> all = goals.take();
    for (int i = 0; i < count(); ++i) add_foot(all, i, now.x);
    return all;
  }

  bool arrived() const override { return arrived_; }

  std::string phase() const override {
    return phase_ == Stance::stand ? kPhaseNames[phase_] : kPhaseNames[phase_] + std::to_string(swing_);
  }

  Eigen::VectorXd state() const override {
    Eigen::VectorXd state(kFixedState + 3 * count() + Course::kStateSize);
    state.head(kFixedState) << begun_, phase_, time_, since_step_, duration_, swing_, previous_, arrived_,
        yaw_, from_, to_, learnt_, asked_, way_.forward, way_.offset, way_.left, ground_;
    for (int i = 0; i < count(); ++i) state.segment<3>(kFixedState + 3 * i) = held_[i];
    state.tail<Course::kStateSize>() = course_.state();
    return state;
  }

  void restore(const Eigen::VectorXd& state) override {
    begun_ = state[0] != 0;
    phase_ = static_cast<Stance::Phase>(static_cast<int>(state[1]));
    time_ = state[2];
    since_step_ = state[3];
    duration_ = state[4];
    swing_ = static_cast<int>(state[5]);
    previous_ = static_cast<int>(state[6]);
    arrived_ = state[7] != 0;
    yaw_ = state[8];
    from_ = state.segment<3>(9);
    to_ = state.segment<3>(12);
    learnt_ = state.segment<3>(15);
    asked_ = state.segment<3>(18);
    way_ = {state.segment<3>(21), state[24], state[25]};
    ground_ = state[26];
    for (int i = 0; i < count(); ++i) held_[i] = state.segment<3>(kFixedState + 3 * i);
    course_.restore(state.tail<Course::kStateSize>());
  }

 private:
  static constexpr int kFixedState = 27;

  int count() const { return static_cast<int>(feet_.size()); }
  static Eigen::Vector3d up() { return Eigen::Vector3d::UnitY(); }

  // What the step begins with.
  void look(const Observation& now) {
    centre_ = centre_of_mass(body_.mass, now.x);
    velocity_ = centre_of_mass(body_.mass, now.v);
    orientation_ = best_rotation(body_.mass, body_.rest, now.x);
    if (!begun_) {
      begun_ = true;
      for (int i = 0; i < count(); ++i) held_[i] = feet_[i].centre(now.x);
      asked_ = velocity_;
      previous_ = count();
      way_.forward = Eigen::Vector3d::Zero();
      yaw_ = yaw_of(orientation_);
    }
    std::vector<Eigen::Vector3d> every, loaded, staying;
    double ground = 0, bearing = 0;
    for (int i = 0; i < count(); ++i) {
      double load = 0, lowest = std::numeric_limits<double>::infinity();
      std::vector<Eigen::Vector3d> points;
      for (const int v : feet_[i].vertices()) {
        points.push_back(spatial_point(now.x, v, body_.dimension()));
        lowest = std::min(lowest, points.back().y());
        if (now.loads.size() > 0) load += now.loads[v];
      }
      every.insert(every.end(), points.begin(), points.end());
      lowest_[i] = lowest;
      loaded_[i] = stands(body_, load);
      if (loaded_[i]) {
        loaded.insert(loaded.end(), points.begin(), points.end());
        ground += lowest;
        ++bearing;
      }
      if (i == swing_) continue;
      staying.insert(staying.end(), points.begin(), points.end());
    }
    if (bearing > 0) ground_ = ground / bearing;
    every_ = Support(every);
    loaded_support_ = Support(loaded.empty() ? staying : loaded);
    staying_ = Support(staying);
    const double rise = std::max(centre_.y() - ground_, 0.1 * body_.height);
    pendulum_ = std::sqrt(body_.gravity / rise);
  }

  bool staying_stand() const {
    for (int i = 0; i < count(); ++i) {
      if (i != swing_ && !loaded_[i]) return false;
    }
    return true;
  }

  // The present step, for the balance. `swing_` is the foot that steps.
  Stance stance() const {
    return {phase_,
            body_.height,
            pendulum_,
            level(centre_ + velocity_ / pendulum_),
            every_,
            loaded_support_,
            staying_,
            level(middle(swing_) + home(swing_)),
            level(phase_ == Stance::swing ? to_ : target(swing_)),
            swing_s_,
            phase_ == Stance::swing ? swing_s_ - time_ : swing_s_};
  }

  // One that the feet on the ground can give without turning the body or leaving the ground.
  Eigen::Vector3d wanted_acceleration() const {
    const Eigen::Vector3d push = balance_->push(stance());
    const double frequency = kHeightFrequency * frequency_;
    const double climb =
        frequency * frequency * (ground_ + rest_rise_ - centre_.y()) - 2 * frequency * velocity_.y();
    return pendulum_ * pendulum_ * level(centre_ - push) +
           std::clamp(climb, -kFall * body_.gravity, kRise * body_.gravity) * up();
  }

  // Upright, but while a foot swings the body leans away from it.
  Eigen::Vector3d turning_rate() const {
    Eigen::Vector3d head = up();
    if (phase_ == Stance::swing) {
      const double part = std::sin(std::numbers::pi * std::min(1.0, time_ / swing_s_));
      head -= part * std::tan(sway_) * home(swing_).normalized();
    }
    Eigen::Vector3d rate = kUprightFrequency * frequency_ * (orientation_ * up()).cross(head.normalized());
    const double yaw = nearest_turn(yaw_ - yaw_of(orientation_));
    rate.y() = std::clamp(kTurnFrequency * yaw, -kLargestTurningRate, kLargestTurningRate);
    return rate;
  }

  // Of foot i, less the middle of the body, as the body shall be turned.
  Eigen::Vector3d home(int i) const { return Eigen::AngleAxisd(yaw_, up()) * feet_[i].home(); }
  // Middle of the body that all feet, or all but one, belong to.
  Eigen::Vector3d middle(int but = -1) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int i = 0; i < count(); ++i) {
      if (i != but) sum += held_[i] - home(i);
    }
    return sum / (but < 0 ? count() : count() - 1);
  }
  // Where foot i shall go: half a step ahead of where it belongs, the others being where they are.
  Eigen::Vector3d target(int i) const {
    double step = step_;
    if (duration_ > 0) step = std::min(step, pace_ * duration_ * count());
    const Eigen::Vector3d others = middle(i);
    const double left = way_.left - way_.forward.dot(others - middle());
    const Eigen::Vector3d aside = -kLineGain * way_.offset * up().cross(way_.forward);
    return others + home(i) + std::min(0.5 * step, left) * way_.forward +
           std::min(1.0, 0.25 * step / std::max(aside.norm(), 1e-9)) * aside;
  }

  // The foot that is farthest behind shall step next; those in front begin.
  void choose(const Observation& now) {
    way_ = course_.way(middle(), step_, now.others);
    if (face_heading_) {
      const double heading = std::atan2(way_.forward.x(), way_.forward.z());
      yaw_ += std::clamp(nearest_turn(heading - yaw_), -kLargestTurn, kLargestTurn);
    }
    const double shortest_at_end = std::min(kShortestAtEnd * body_.height, kShortestShareAtEnd * step_);
    const double shortest = std::max(kShortest * body_.height, course_.ends(way_) ? shortest_at_end : 0);
    double longest = 0;
    int next = -1;
    for (int i = 0; i < count(); ++i) {
      const double lag = level(target(i) - held_[i]).norm();
      const double early = kShortest * way_.forward.dot(home(i));
      if (i == previous_ || lag < shortest || lag + early <= longest) continue;
      longest = lag + early;
      next = i;
    }
    if (next < 0) {
      arrived_ = course_.ends(way_);
      previous_ = count();
      enter(Stance::stand);
    } else {
      swing_ = next;
      enter(Stance::shift);
    }
  }

  // From where the feet are, with another foot than the last.
  void go_on(const Observation& now) {
    for (int i = 0; i < count(); ++i) held_[i] = feet_[i].centre(now.x);
    previous_ = swing_;
    choose(now);
  }

  void enter(Stance::Phase phase) {
    phase_ = phase;
    time_ = 0;
  }

  void advance(const Observation& now) {
    switch (phase_) {
      case Stance::stand:
        since_step_ = 0;
        if (stands(body_, now.load)) choose(now);
        break;
      case Stance::shift: {
        if (time_ > kLongestShift * swing_s_) {  // it leans on the foot that shall step
          go_on(now);
          break;
        }
        if (!staying_stand() || !balance_->can_step(stance())) break;
        from_ = feet_[swing_].centre(now.x);
        to_ = target(swing_);
        enter(Stance::swing);
        break;
      }
      case Stance::swing: {
        if (balance_->must_land(stance())) time_ = std::max(time_, swing_s_);
        const bool early = time_<kEarliestLanding * swing_s_, late = time_> kLatestLanding * swing_s_;
        if (early || !(loaded_[swing_] || late)) break;
        duration_ = since_step_;
        since_step_ = 0;
        go_on(now);
        break;
      }
    }
  }

  // Where a foot on its way shall be, and how fast it shall go.
  std::pair<Eigen::Vector3d, Eigen::Vector3d> swing_path() const {
    constexpr double pi = std::numbers::pi;
    const double t = time_ / swing_s_, part = std::min(t, 1.0), sinking = kSinking * speed_;
    const Eigen::Vector3d way = level(to_ - from_) + balance_->further(stance());
    Eigen::Vector3d at = from_ + smooth_step(part) * way;
    Eigen::Vector3d rate = 6 * part * (1 - part) / swing_s_ * way;
    at.y() += lift_ * std::sin(pi * part) - sinking * std::max(0.0, time_ - swing_s_);
    rate.y() += t < 1 ? pi * lift_ / swing_s_ * std::cos(pi * part) : -sinking;
    return {at, rate};
  }

  void add_foot(std::vector<Goal>& goals, int i, const Eigen::VectorXd& x) const {
    const double kd = std::sqrt(kFootEffort * body_.mass.sum());
    FootTarget target{.yaw = yaw_};
    if (phase_ == Stance::swing && i == swing_) {
      std::tie(target.at, target.rate) = swing_path();
      target.upright = kUprightFrequency * frequency_;
      feet_[i].add_goals(x, target, kSwingFrequency * frequency_ * kd, kd, goals);
    } else {  // it keeps its place on the ground, and feels for the ground when it is not there
      target.at = held_[i];
      target.at.y() = loaded_[i] ? feet_[i].standing_height(x, lowest_[i]) : feet_[i].centre(x).y();
      target.rate = {0, loaded_[i] ? 0 : -kSinking * speed_, 0};
      feet_[i].add_goals(x, target, kStanceFrequency * frequency_ * kd, kd, goals);
    }
  }

  ControlledBody body_;
  Course course_;
  double pace_, step_, lift_, swing_s_, sway_, weight_, upright_;
  bool face_heading_;
  std::unique_ptr<WalkingBalance> balance_;
  double frequency_, speed_;  // √(g / L), 1/s, and √(g L), m/s
  double rest_rise_ = 0;      // of the centre of mass above the lowest vertex at rest, m
  std::vector<Foot> feet_;

  bool begun_ = false;
  Stance::Phase phase_ = Stance::stand;
  double time_ = 0;               // since the phase began, s
  double since_step_ = 0;         // since a foot landed, s
  double duration_ = 0;           // of the last step, s
  int swing_ = 0, previous_ = 0;  // the foot that steps, and the last one that did
  bool arrived_ = false;
  double yaw_ = 0;  // by which the body shall be turned
  Eigen::Vector3d from_ = Eigen::Vector3d::Zero(), to_ = Eigen::Vector3d::Zero();  // of the step, m
  Eigen::Vector3d learnt_ = Eigen::Vector3d::Zero();  // added to the velocity that is asked for, m/s
  Eigen::Vector3d asked_ = Eigen::Vector3d::Zero();   // velocity wanted of the last step, m/s
  Course::Way way_ = {Eigen::Vector3d::Zero(), 0, 0};
  std::vector<Eigen::Vector3d> held_;  // centres of the feet when the last one landed, m

  // Of the present step.
  Eigen::Vector3d centre_, velocity_;
  Eigen::Matrix3d orientation_;
  std::vector<bool> loaded_;                  // feet that the ground bears
  std::vector<double> lowest_;                // heights of the feet, m
  Support every_, loaded_support_, staying_;  // as in the stance
  double ground_ = 0;                         // height under the feet that bear the body, m
  double pendulum_ = 0;                       // ω, 1/s
};

}  // namespace

Schema walk_controller_schema() {
  const char* corner = "in shares of the bounding box of the body at rest.";
  return add_course(
             object("Walks along a course: the centre of mass goes above the feet that stay, another "
                    "foot steps. A body of space rocks from foot to foot instead. At its end it stands."))
      .field("feet", list("The feet, two or more; of a body of space their soles.",
                          object("A foot: the vertices in a box.")
                              .field("min", vector(std::string("Lower corner, ") + corner, 3).required())
                              .field("max", vector(std::string("Upper corner, ") + corner, 3).required()))
                         .items_at_least(2)
                         .required())
      .field("speed",
             number("Speed of travel, as far as the steps allow.").unit("m/s").above(0).initially(0.3))
      .field("step", number("Longest step as a share of the body's height.").above(0).initially(0.25))
      .field(
          "lift",
          number("How high a foot is raised, as a share of the body's height.").at_least(0).initially(0.08))
      .field("swing_s", number("Duration of a foot's way.").unit("s").above(0).initially(0.3))
      .field("sway_deg",
             number("How far the body leans away from a foot that steps.").unit("°").initially(0.0))
      .field("face_heading",
             boolean("Turn the front of the character (+z at rest) towards the heading.").initially(false))
      .field("effort",
             number("Weight of the centre-of-mass goals against the cost of changing the rest shape.")
                 .above(0)
                 .initially(6))
      .field("upright", number("Weight of the goals that turn the body, relative to its inertia.")
                            .at_least(0)
                            .initially(10));
}

std::unique_ptr<Controller> make_walk_controller(const ControlledBody& body, const Value& settings) {
  return std::make_unique<WalkController>(body, settings);
}

}  // namespace vivify::sim
