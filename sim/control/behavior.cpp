#include "sim/control/behavior.h"

#include <algorithm>

#include "common/registry.h"
#include "sim/handles.h"

namespace vivify::sim {
namespace {

// A behaviour ends when its controller has arrived, unless a condition is given.
struct Behavior {
  std::unique_ptr<Controller> controller;
  std::optional<double> duration;  // s
  std::string until;               // a body that has arrived
  bool has_condition() const { return duration || !until.empty(); }
};

class Script final : public Controller {
 public:
  Script(std::vector<Behavior> behaviors, double h) : behaviors_(std::move(behaviors)), h_(h) {}

  std::vector<Goal> goals(const Observation& now) override {
    ended_ = has_ended(now.others);
    if (ended_ && !is_last()) {
      ++index_;
      steps_ = 0;
      ended_ = false;
    }
    ++steps_;
    return current().goals(now);
  }

  bool arrived() const override {
    return is_last() && (behaviors_[index_].has_condition() ? ended_ : current().arrived());
  }
  int behavior() const override { return static_cast<int>(index_); }
  bool passive() const override { return current().passive(); }
  std::optional<Eigen::VectorXd> rest_parameters(double) const override {
    return current().rest_parameters(time());
  }
  std::string phase() const override { return current().phase(); }

  Eigen::VectorXd state() const override {
    const Eigen::VectorXd inner = current().state();
    Eigen::VectorXd state(3 + inner.size());
    state << static_cast<double>(index_), static_cast<double>(steps_), ended_, inner;
    return state;
  }
  void restore(const Eigen::VectorXd& state) override {
    index_ = static_cast<std::size_t>(state[0]);
    steps_ = static_cast<long>(state[1]);
    ended_ = state[2] != 0;
    current().restore(state.tail(state.size() - 3));
  }

 private:
  Controller& current() const { return *behaviors_[index_].controller; }
  bool is_last() const { return index_ + 1 == behaviors_.size(); }
  double time() const { return static_cast<double>(steps_) * h_; }  // spent in the present behaviour

  bool has_ended(Others others) const {
    const Behavior& now = behaviors_[index_];
    if (now.duration && time() >= *now.duration - kTimeTolerance * h_) return true;
    if (!now.until.empty()) {
      return std::any_of(others.begin(), others.end(),
                         [&](const OtherBody& other) { return other.name == now.until && other.arrived; });
    }
    return !now.has_condition() && now.controller->arrived();
  }

  std::vector<Behavior> behaviors_;
  double h_;
  std::size_t index_ = 0;
  long steps_ = 0;      // of the present behaviour
  bool ended_ = false;  // the present behaviour; the last one goes on
};

constexpr std::string_view kArrived = ".arrived";

// The body of a condition "NAME.arrived"; empty when there is no condition.
std::string waited_for(const Value& behavior) {
  if (!behavior.has("until")) return {};
  const std::string& text = behavior["until"].as_string();
  if (text.ends_with(kArrived) && text.size() > kArrived.size())
    return text.substr(0, text.size() - kArrived.size());
  throw Error(ErrorKind::usage, "until = " + text + " must be NAME.arrived", "for example ball.arrived",
              behavior["until"].where());
}

}  // namespace

Schema behavior_schema() {
  Schema behavior = one_of(
      "A behaviour: the name of a controller with its settings. It ends when the controller has "
      "arrived or, when they are given, as `for_s` and `until` say. The last one goes on after its end.");
  for (const ControllerEntry& entry : controllers()) {
    behavior = std::move(behavior).option(
        std::string(entry.name),
        entry.schema()
            .field("for_s", number("Ends after this time.").unit("s").above(0))
            .field("until",
                   string("Ends when another body has done all that it was asked for: `NAME.arrived`.")));
  }
  return list("What the body does, one behaviour after the other, in place of `controller`.",
              std::move(behavior));
}

std::vector<std::pair<std::string, Value>> looked_at(const Value& settings) {
  std::vector<std::pair<std::string, Value>> names;
  for (const char* key : {"chase", "flee", "towards"}) {
    if (settings.has(key)) names.emplace_back(key, settings[key]);
  }
  if (const std::string other = waited_for(settings); !other.empty()) {
    names.emplace_back("until", Value::string(other));
    names.back().second.set_where(settings["until"].where());
  }
  return names;
}

std::unique_ptr<Controller> make_script(const ControlledBody& body, const Value& behavior) {
  std::vector<Behavior> behaviors;
  for (const Value& item : behavior.items()) {
    const auto& [name, settings] = item.entries().front();
    Behavior& made = behaviors.emplace_back();
    made.controller = find_entry(controllers(), name, "controller").make(body, settings);
    if (settings.has("for_s")) made.duration = settings["for_s"].as_number();
    made.until = waited_for(settings);
  }
  return std::make_unique<Script>(std::move(behaviors), body.h);
}

}  // namespace vivify::sim
