#include "sim/control/controllers/goals.h"

#include <algorithm>
#include <cmath>

#include "sim/control/rigid_motion.h"
#include "sim/region.h"

namespace vivify::sim {
namespace {

struct Key {
  double t;            // s
  double value, rate;  // m and m/s, or 1/s about the axis of a spin
};

struct KeyedGoal {
  std::string of;
  Eigen::Vector3d along;      // unit
  std::vector<int> vertices;  // of a region
  bool from_centre;
  double weight, frequency;  // k_d² over mass or inertia; k_p over k_d, 1/s
  double at_rest;            // a·x there, from which values count
  std::vector<Key> keys;
};

// Value and rate at a time: the value goes in straight lines from key to key, with its slope added to the
// rate.
Key at(const std::vector<Key>& keys, double t) {
  const auto next =
      std::upper_bound(keys.begin(), keys.end(), t, [](double time, const Key& key) { return time < key.t; });
  if (next == keys.begin()) return keys.front();
  if (next == keys.end()) return keys.back();
  const Key& from = *(next - 1);
  const double slope = (next->value - from.value) / (next->t - from.t),
               share = (t - from.t) / (next->t - from.t);
  return {t, from.value + slope * (t - from.t), slope + (1 - share) * from.rate + share * next->rate};
}

class GoalsController final : public Controller {
 public:
  GoalsController(const ControlledBody& body, std::vector<KeyedGoal> goals, std::optional<double> period)
      : body_(body), goals_(std::move(goals)), period_(period) {
    for (KeyedGoal& goal : goals_) goal.at_rest = goal.of == "spin" ? 0 : weights(goal).dot(body.rest);
  }

  std::vector<Goal> goals(const Observation& now) override {
    ++steps_;
    double t = static_cast<double>(steps_) * body_.h;  // at the end of the step
    if (period_) t = std::fmod(t, *period_);
    std::vector<Goal> goals;
    for (const KeyedGoal& keyed : goals_) {
      const Key wanted = at(keyed.keys, t);
      const bool spins = keyed.of == "spin";
      Eigen::VectorXd a = spins ? spin_weights(body_.mass, now.x, keyed.along) : weights(keyed);
      const double size = spins ? inertia_about(now.x, keyed.along) : body_.mass.sum();
      const double kd = std::sqrt(keyed.weight * size);
      goals.push_back(
          {std::move(a), spins ? 0 : keyed.frequency * kd, kd, keyed.at_rest + wanted.value, wanted.rate});
    }
    return goals;
  }

  std::string phase() const override { return "goals"; }
  Eigen::VectorXd state() const override { return Eigen::VectorXd::Constant(1, static_cast<double>(steps_)); }
  void restore(const Eigen::VectorXd& state) override { steps_ = static_cast<long>(state[0]); }

 private:
  Eigen::VectorXd weights(const KeyedGoal& goal) const {
    const int d = body_.dimension();
    Eigen::VectorXd centre = centre_of_mass_weights(body_.mass, goal.along, d);
    if (goal.of == "centre") return centre;
    Eigen::VectorXd a = goal.from_centre ? Eigen::VectorXd(-centre) : Eigen::VectorXd::Zero(centre.size());
    for (const int i : goal.vertices)
      a.segment(d * i, d) += goal.along.head(d) / static_cast<double>(goal.vertices.size());
    return a;
  }
  double inertia_about(const Eigen::VectorXd& x, const Eigen::Vector3d& axis) const {
    return axis.dot(inertia_tensor(body_.mass, x) * axis);
  }

  ControlledBody body_;
  std::vector<KeyedGoal> goals_;
  std::optional<double> period_;
  long steps_ = 0;
};

Schema keys_schema() {
  return list(
             "Targets over time, in straight lines from one to the next; before the first and after the last "
             "they "
             "stay.",
             object("Target at a time.")
                 .field("t", number("Time since the controller began.").unit("s").at_least(0).initially(0))
                 .field("value",
                        number("Target of the coordinate, from where it is at rest; a spin has none.")
                            .unit("m")
                            .initially(0))
                 .field("rate",
                        number("Target of its rate, on top of the slope of the values: m/s, of a spin "
                               "radians per second.")
                            .initially(0)))
      .items_at_least(1)
      .required();
}

}  // namespace

Schema goals_controller_schema() {
  Schema region =
      object("Part of the body: the vertices in a box. Left out: all of it.")
          .field("min",
                 vector("Lower corner, in shares of the bounding box at rest.", 3).initially({0, 0, 0}))
          .field("max",
                 vector("Upper corner, in shares of the bounding box at rest.", 3).initially({1, 1, 1}));
  Schema goal =
      object("One scalar goal k_p (s − s_x) + k_d (s' − s_v) of a coordinate s of the body, (6).")
          .field("of",
                 choice("What it is about: the centre of mass, the middle of a region, or the turning of the "
                        "body as a whole.",
                        {"centre", "region", "spin"})
                     .initially("centre"))
          .field("along", vector("Direction of the coordinate, or axis of the spin, of any length.", 3)
                              .initially({0, 1, 0}))
          .field("region", std::move(region))
          .field("from_centre",
                 boolean("Whether the place of the region counts from the centre of mass.").initially(false))
          .field("weight",
                 number("k_d² over the mass, of a spin over the moment of inertia.").above(0).initially(1))
          .field("frequency",
                 number("k_p over k_d: 0 asks for the rate only.").unit("1/s").at_least(0).initially(0))
          .field("keys", keys_schema());
  return object("Goals as they are written here, each on its own: for controllers that are not built in.")
      .field("goals", list("The goals.", std::move(goal)).items_at_least(1).required())
      .field("period_s", number("After this time the keys begin again.").unit("s").above(0));
}

void check_goals(const Value& settings, const std::string& where, std::vector<Error>& errors) {
  if (!settings.has("goals")) return;
  const std::vector<Value>& goals = settings["goals"].items();
  for (std::size_t i = 0; i < goals.size(); ++i) {
    const auto fail = [&](const Value& part, const std::string& message, const std::string& hint) {
      errors.emplace_back(ErrorKind::usage, where + ".goals[" + std::to_string(i) + "]" + message, hint,
                          part.where());
    };
    const Value& along = goals[i]["along"];
    if (along.as_vector3().norm() == 0) fail(along, ".along must not be 0", "give a direction");
    const std::vector<Value>& keys = goals[i]["keys"].items();
    const Value& value = keys.front()["value"];
    const bool stays = std::all_of(keys.begin(), keys.end(), [&](const Value& key) {
      return key["value"].as_number() == value.as_number();
    });
    if (stays && value.as_number() != 0 && goals[i]["frequency"].as_number() == 0)
      fail(value, ".keys: a value that stays asks for nothing, as frequency is 0",
           "give the goal a frequency, in 1/s");
    double last = -1;
    for (const Value& key : keys) {
      const double t = key["t"].as_number();
      if (t <= last) fail(key, ".keys must be in the order of time", "let each t be after the one before it");
      if (settings.has("period_s") && t > settings["period_s"].as_number())
        fail(key, ".keys has a time after period_s, when the keys begin again", "make the period longer");
      last = t;
    }
  }
}

std::unique_ptr<Controller> make_goals_controller(const ControlledBody& body, const Value& settings) {
  std::vector<Error> errors;
  check_goals(settings, "the controller", errors);
  if (!errors.empty()) throw errors.front();
  std::vector<KeyedGoal> goals;
  for (const Value& item : settings["goals"].items()) {
    KeyedGoal& goal = goals.emplace_back();
    goal.of = item["of"].as_string();
    goal.along = item["along"].as_vector3();
    goal.along.normalize();
    const RowMatrixXd V = Eigen::Map<const RowMatrixXd>(body.rest.data(), body.mass.size(), body.dimension());
    const Region part =
        region_between(item["region"], "goals[" + std::to_string(goals.size() - 1) + "]", item.where());
    if (goal.of == "region") goal.vertices = held_vertices(std::span(&part, 1), V).front();
    goal.from_centre = item["from_centre"].as_bool();
    goal.weight = item["weight"].as_number();
    goal.frequency = item["frequency"].as_number();
    for (const Value& key : item["keys"].items()) {
      goal.keys.push_back({key["t"].as_number(), key["value"].as_number(), key["rate"].as_number()});
    }
  }
  std::optional<double> period;
  if (settings.has("period_s")) period = settings["period_s"].as_number();
  return std::make_unique<GoalsController>(body, std::move(goals), period);
}

}  // namespace vivify::sim
