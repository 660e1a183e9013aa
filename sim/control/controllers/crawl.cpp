#include "sim/control/controllers/crawl.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/control/body_goals.h"
#include "sim/control/course.h"
#include "sim/control/rigid_motion.h"

namespace vivify::sim {
namespace {

constexpr double kHump = 2;              // segments that are on their way at once
constexpr double kMoveFrequency = 20;    // k_p over k_d of a segment on its way, 1/s
constexpr double kStayFrequency = 6;     // of one that stays
constexpr double kUprightFrequency = 8;  // wanted turning rate per radian of tilt, 1/s
constexpr double kYawFrequency = 2;      // and per radian about the vertical
constexpr double kUprightWeight = 2;     // of these goals, relative to the inertia
constexpr double kLineGain = 0.5;  // tangent of the angle to the line, per length that the body is off it
constexpr double kLargestBack = 0.5;
constexpr double kLargestAside = 0.6;  // how far from its length it steps aside meanwhile, radians
constexpr double kLargestTurn = 0.15;  // of the body in a wave, radians

struct Segment {
  Eigen::VectorXd mass;  // of its vertices, 0 elsewhere, kg
  Eigen::Vector3d home;  // its centre less that of the body at rest, horizontally, m
};

Eigen::Vector3d level(const Eigen::Vector3d& v) { return {v.x(), 0, v.z()}; }

// Of the course, seen from above: 0 is +z.
double angle_of(const Eigen::Vector3d& v) { return std::atan2(v.x(), v.z()); }

class CrawlController final : public Controller {
 public:
  CrawlController(const ControlledBody& body, const Value& settings)
      : body_(body),
        course_(body, settings),
        wave_s_(settings["wave_s"].as_number()),
        lift_(settings["lift"].as_number() * body.height),
        effort_(settings["effort"].as_number()) {
    const int d = body.dimension(), n = static_cast<int>(settings["segments"].as_integer());
    const Eigen::Map<const Eigen::MatrixXd> V(body.rest.data(), d, body.mass.size());
    const Eigen::VectorXd low = V.rowwise().minCoeff(), size = V.rowwise().maxCoeff() - low;
    const int along = d == 3 && size[2] > size[0] ? 2 : 0;
    axis_ = Eigen::Vector3d::Unit(along);
    length_ = size[along];
    stride_ = settings["stride"].as_number() * length_;
    segments_.resize(static_cast<std::size_t>(n));
    for (Segment& segment : segments_) segment.mass = Eigen::VectorXd::Zero(body.mass.size());
    for (int v = 0; v < body.mass.size(); ++v) {
      const int i = std::min(n - 1, static_cast<int>(n * (V(along, v) - low[along]) / length_));
      segments_[i].mass[v] = body.mass[v];
    }
    const Eigen::Vector3d centre = centre_of_mass(body.mass, body.rest);
    for (Segment& segment : segments_) {
      if (segment.mass.isZero(0)) {
        throw Error(ErrorKind::usage, std::to_string(n) + " segments are more than the simulation mesh has",
                    "use fewer segments, or more vertices", settings.where());
      }
      const Eigen::Vector3d place = centre_of_mass(segment.mass, body.rest);
      segment.home = level(place - centre);
    }
    held_.assign(segments_.size(), Eigen::Vector3d::Zero());
    to_ = held_;
    time_ = wave_s_;
  }

  std::vector<Goal> goals(const Observation& now) override {
    const double h = body_.h;
    standing_ = stands(body_, now.load);
    if (!begun_ && !standing_) return {};
    begun_ = true;
    time_ += h;
    if (time_ >= wave_s_) begin_wave(now);
    std::vector<Goal> goals = upright(now.x);
    for (int i = 0; i < count(); ++i) {
      const double part = progress(i, time_), before = progress(i, time_ - h);
      if ((before <= 0 && part > 0) || (before < 1 && part >= 1)) held_[i] = place(i, now.x);
      add_segment(goals, i, part);
    }
    return goals;
  }

  bool arrived() const override { return arrived_; }
  std::string phase() const override { return !standing_ ? "flight" : arrived_ ? "stand" : "crawl"; }

  Eigen::VectorXd state() const override {
    Eigen::VectorXd state(kFixedState + 6 * count() + Course::kStateSize);
    state.head(kFixedState) << begun_, standing_, arrived_, time_, yaw_, sense_;
    for (int i = 0; i < count(); ++i) {
      state.segment<3>(kFixedState + 6 * i) = held_[i];
      state.segment<3>(kFixedState + 6 * i + 3) = to_[i];
    }
    state.tail<Course::kStateSize>() = course_.state();
    return state;
  }
  void restore(const Eigen::VectorXd& state) override {
    begun_ = state[0] != 0;
    standing_ = state[1] != 0;
    arrived_ = state[2] != 0;
    time_ = state[3];
    yaw_ = state[4];
    sense_ = static_cast<int>(state[5]);
    for (int i = 0; i < count(); ++i) {
      held_[i] = state.segment<3>(kFixedState + 6 * i);
      to_[i] = state.segment<3>(kFixedState + 6 * i + 3);
    }
    course_.restore(state.tail<Course::kStateSize>());
  }

 private:
  static constexpr int kFixedState = 6;

  int count() const { return static_cast<int>(segments_.size()); }
  Eigen::Vector3d place(int i, const Eigen::VectorXd& x) const {
    return centre_of_mass(segments_[i].mass, x);
  }
  // From 0 to 1 while segment i is on its way; the tail goes first.
  double progress(int i, double time) const {
    if (arrived_) return 0;
    const int behind = sense_ > 0 ? i : count() - 1 - i;
    const double each = wave_s_ / (count() - 1 + kHump);
    return std::clamp((time - behind * each) / (kHump * each), 0.0, 1.0);
  }

  void begin_wave(const Observation& now) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (int i = 0; i < count(); ++i) {
      held_[i] = place(i, now.x);
      middle += (held_[i] - home(i)) / count();
    }
    const Course::Way way = course_.way(middle, length_, now.others);
    arrived_ = arrived_ || course_.ends(way);
    time_ = 0;
    // The end that is nearer to the course leads; the body turns until it lies along it.
    const double back = std::clamp(-kLineGain * way.offset / length_, -kLargestBack, kLargestBack);
    const double course = angle_of(way.forward + back * up().cross(way.forward));
    double off = nearest_turn(course - angle_of(axis_) - yaw_);
    sense_ = std::cos(off) >= 0 ? 1 : -1;
    if (sense_ < 0) off = nearest_turn(off - std::numbers::pi);
    if (body_.dimension() == 3) yaw_ += std::clamp(off, -kLargestTurn, kLargestTurn);
    off -= std::clamp(off, -kLargestTurn, kLargestTurn);
    const double aside = std::clamp(off, -kLargestAside, kLargestAside);
    const Eigen::Vector3d step =
        std::min(stride_, way.left) * sense_ * (Eigen::AngleAxisd(yaw_ + aside, up()) * axis_);
    for (int i = 0; i < count(); ++i) to_[i] = middle + home(i) + step;
  }

  static Eigen::Vector3d up() { return Eigen::Vector3d::UnitY(); }
  Eigen::Vector3d home(int i) const { return Eigen::AngleAxisd(yaw_, up()) * segments_[i].home; }

  // Keeps a body of space from rolling over.
  std::vector<Goal> upright(const Eigen::VectorXd& x) const {
    BodyGoals goals(body_, x);
    if (body_.dimension() == 3) {
      const Eigen::Matrix3d R = best_rotation(body_.mass, body_.rest, x);
      Eigen::Vector3d rate = upright_rate(R, kUprightFrequency);
      rate.y() = kYawFrequency * nearest_turn(yaw_ - yaw_of(R));
      goals.spin(kUprightWeight * effort_, rate);
    }
    return goals.take();
  }

  void add_segment(std::vector<Goal>& goals, int i, double part) const {
    constexpr double pi = std::numbers::pi;
    const Segment& segment = segments_[i];
    const double duration = kHump * wave_s_ / (count() - 1 + kHump);
    const bool moves = part > 0 && part < 1;
    Eigen::Vector3d at = held_[i], rate = Eigen::Vector3d::Zero();
    if (moves) {
      const Eigen::Vector3d way = level(to_[i] - held_[i]);
      at += smooth_step(part) * way + lift_ * std::sin(pi * part) * std::sin(pi * part) * up();
      rate = 6 * part * (1 - part) / duration * way + pi * lift_ / duration * std::sin(2 * pi * part) * up();
    }
    const double kd = std::sqrt(effort_ * segment.mass.sum());
    const double kp = (moves ? kMoveFrequency : kStayFrequency) * kd;
    for (int axis = 0; axis < body_.dimension(); ++axis) {
      if (axis == 1 && !moves) continue;  // its weight holds it down
      goals.push_back({centre_of_mass_weights(segment.mass, Eigen::Vector3d::Unit(axis), body_.dimension()),
                       kp, kd, at[axis], rate[axis]});
    }
  }

  ControlledBody body_;
  Course course_;
  double wave_s_, lift_, effort_;
  double length_ = 0, stride_ = 0;  // m
  Eigen::Vector3d axis_;            // from tail to head at rest
  std::vector<Segment> segments_;

  bool begun_ = false, standing_ = false, arrived_ = false;
  double time_ = 0;                         // since the wave began, s
  double yaw_ = 0;                          // by which the body shall be turned
  int sense_ = 1;                           // 1: its far end along the axis leads
  std::vector<Eigen::Vector3d> held_, to_;  // where each segment stays or set out from, and where it goes, m
};

}  // namespace

Schema crawl_controller_schema() {
  return add_course(object("Crawls along a course: a hump travels along the body from its tail to its head, "
                           "and what is "
                           "in it is brought forward. For long, low bodies; the end that is nearer to the "
                           "course leads."))
      .field("segments", integer("Parts of the body, along its length.").at_least(2).at_most(20).initially(6))
      .field("stride", number("How far a wave brings the body, as a share of its length.")
                           .above(0)
                           .at_most(0.5)
                           .initially(0.15))
      .field("wave_s", number("Duration of a wave.").unit("s").above(0).initially(0.8))
      .field(
          "lift",
          number("Height of the hump as a share of the body's height.").at_least(0).at_most(1).initially(0.6))
      .field(
          "effort",
          number("Weight of the goals against the cost of changing the rest shape.").above(0).initially(0.4));
}

std::unique_ptr<Controller> make_crawl_controller(const ControlledBody& body, const Value& settings) {
  return std::make_unique<CrawlController>(body, settings);
}

}  // namespace vivify::sim
