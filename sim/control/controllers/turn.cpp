#include "sim/control/controllers/turn.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sim/control/body_goals.h"
#include "sim/control/controllers/hop.h"
#include "sim/control/rigid_motion.h"

namespace vivify::sim {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kTolerance = 4 * kDegree;  // how nearly it shall look there
constexpr double kLeastGain = 0.2;          // of a hop: how far it turns, of what was asked
constexpr double kLargestGain = 1.5;
constexpr double kLeastTold = 5 * kDegree;  // asked of a hop that tells the gain

constexpr std::array kWays = {"by_deg", "to_deg", "towards"};
// Settings of `hop` that a turn has too.
constexpr std::array kOfHop = {"height", "crouch_depth", "crouch_s", "thrust_s",
                               "land_s", "effort",       "upright",  "feet_ahead"};

class TurnController final : public Controller {
 public:
  TurnController(const ControlledBody& body, const Value& settings)
      : body_(body), per_hop_(settings["per_hop_deg"].as_number() * kDegree) {
    if (settings.has("by_deg")) by_ = settings["by_deg"].as_number() * kDegree;
    if (settings.has("to_deg")) heading_ = settings["to_deg"].as_number() * kDegree;
    if (settings.has("towards")) other_ = settings["towards"].as_string();
    std::vector<Error> errors;
    ConfigNode defaults;
    defaults.kind = ConfigNode::Kind::map;
    hop_settings_ = resolve(hop_controller_schema(), defaults, errors);
    hop_settings_.set_where(settings.where());
    for (const char* key : kOfHop) hop_settings_.set(key, settings[key]);
    hop_settings_.set("pace", Value::number(0));
    hop_settings_.set("count", Value::integer(1));
    begin_hop(0);
  }

  std::vector<Goal> goals(const Observation& now) override {
    look(now);
    const bool over = begun_ && hop_->arrived();
    if (over && !arrived_) {
      if (std::abs(asked_) > kLeastTold) {
        const double gain = std::clamp(turned_ / asked_, kLeastGain, kLargestGain);
        gain_ = 0.5 * (gain_ + gain);
      }
      arrived_ = std::abs(left_) < kTolerance;
    }
    if (!begun_ || (over && !arrived_)) begin_hop(std::clamp(left_, -per_hop_, per_hop_) / gain_);
    begun_ = true;
    return hop_->goals(now);
  }

  bool arrived() const override { return arrived_; }
  std::string phase() const override { return hop_->phase(); }

  Eigen::VectorXd state() const override {
    const Eigen::VectorXd hop = hop_->state();
    Eigen::VectorXd state(kFixedState + hop.size());
    state << begun_, arrived_, yaw_, heading_, left_, turned_, asked_, gain_, hop;
    return state;
  }
  void restore(const Eigen::VectorXd& state) override {
    begin_hop(state[6]);
    begun_ = state[0] != 0;
    arrived_ = state[1] != 0;
    yaw_ = state[2];
    heading_ = state[3];
    left_ = state[4];
    turned_ = state[5];
    gain_ = state[7];
    hop_->restore(state.tail(state.size() - kFixedState));
  }

 private:
  static constexpr int kFixedState = 8;

  // How far it has turned, and how far it has to go.
  void look(const Observation& now) {
    const double yaw = yaw_of(best_rotation(body_.mass, body_.rest, now.x));
    const double turned = begun_ ? nearest_turn(yaw - yaw_) : 0;
    yaw_ = yaw;
    turned_ += turned;
    if (by_) {
      left_ = begun_ ? left_ - turned : *by_;
      return;
    }
    const Eigen::Vector3d centre = centre_of_mass(body_.mass, now.x);
    for (const OtherBody& other : now.others) {
      const Eigen::Vector3d way = other.centre - centre;
      if (other.name == other_) heading_ = std::atan2(way.x(), way.z());
    }
    left_ = nearest_turn(heading_ - yaw_);
  }

  void begin_hop(double turn) {
    asked_ = turn;
    turned_ = 0;
    hop_settings_.set("turn_deg", Value::number(turn / kDegree));
    hop_ = make_hop_controller(body_, hop_settings_);
  }

  ControlledBody body_;
  Value hop_settings_;
  double per_hop_;            // radians, as all angles
  std::optional<double> by_;  // turns by it, or
  double heading_ = 0;        // to it, or
  std::string other_;         // to where this body is

  std::unique_ptr<Controller> hop_;  // the present one, and the one after which it stands
  bool begun_ = false, arrived_ = false;
  double yaw_ = 0, left_ = 0;
  double asked_ = 0, turned_ = 0;  // of the present hop
  double gain_ = 1;                // turned over asked, learnt
};

}  // namespace

Schema turn_controller_schema() {
  Schema schema =
      object(
          "Turns about the vertical in small hops on the spot, until the character looks where it shall, and "
          "then stands. One of `by_deg`, `to_deg` and `towards` says where.")
          .field("by_deg", number("Angle to turn by, to the left when positive.").unit("°"))
          .field("to_deg",
                 number("Direction that its front (+z at rest) shall look to: 0 is +z, 90 is +x.").unit("°"))
          .field("towards", string("Name of a body that it shall look at."))
          .field("per_hop_deg",
                 number("Largest turn of a hop.").unit("°").above(0).at_most(180).initially(30));
  for (auto& [key, field] : hop_controller_schema().fields) {
    if (std::find(kOfHop.begin(), kOfHop.end(), key) == kOfHop.end()) continue;
    if (key == "height") field = std::move(field).initially(0.1);
    schema = std::move(schema).field(key, field);
  }
  return schema;
}

std::unique_ptr<Controller> make_turn_controller(const ControlledBody& body, const Value& settings) {
  std::vector<Error> errors;
  check_turn(settings, "the controller", body.dimension() == 2, errors);
  if (!errors.empty()) throw errors.front();
  return std::make_unique<TurnController>(body, settings);
}

void check_turn(const Value& settings, const std::string& where, bool planar, std::vector<Error>& errors) {
  if (!settings.has("per_hop_deg")) return;
  const auto fail = [&](const std::string& message, const std::string& hint) {
    errors.emplace_back(ErrorKind::usage, where + message, hint, settings.where());
  };
  if (planar) fail(": a body of the plane cannot turn about the vertical", "leave the turn out");
  const auto given =
      std::count_if(kWays.begin(), kWays.end(), [&](const char* key) { return settings.has(key); });
  if (given != 1) fail(" needs one of by_deg, to_deg and towards", "give exactly one of them");
}

}  // namespace vivify::sim
