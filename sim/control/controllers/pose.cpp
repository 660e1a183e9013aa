#include "sim/control/controllers/pose.h"

#include <algorithm>

#include "sim/control/keyed_weights.h"

namespace vivify::sim {
namespace {

class PoseController final : public Controller {
 public:
  PoseController(const ControlledBody& body, const Value& settings, Eigen::Index example)
      : h_(body.h),
        take_s_(settings["take_s"].as_number()),
        hold_s_(settings["hold_s"].as_number()),
        leave_s_(settings["leave_s"].as_number()),
        pose_(body.poses.col(example)),
        start_(Eigen::VectorXd::Zero(pose_.size())) {}

  std::vector<Goal> goals(const Observation& now) override {
    if (steps_ == 0) start_ = now.p;
    ++steps_;
    return {};
  }

  std::optional<Eigen::VectorXd> rest_parameters(double) const override {
    const double held = take_s_ + hold_s_;
    return weights_at({{0, start_}, {take_s_, pose_}, {held, pose_}, {end(), 0 * pose_}}, true, time());
  }

  bool arrived() const override { return time() >= end(); }

  std::string phase() const override {
    const double t = time();
    return t < take_s_ ? "take" : t < take_s_ + hold_s_ ? "hold" : t < end() ? "leave" : "stand";
  }

  Eigen::VectorXd state() const override {
    Eigen::VectorXd state(1 + start_.size());
    state << static_cast<double>(steps_), start_;
    return state;
  }
  void restore(const Eigen::VectorXd& state) override {
    steps_ = static_cast<long>(state[0]);
    start_ = state.tail(state.size() - 1);
  }

 private:
  double time() const { return static_cast<double>(steps_) * h_; }
  double end() const { return take_s_ + hold_s_ + leave_s_; }

  double h_, take_s_, hold_s_, leave_s_;
  Eigen::VectorXd pose_, start_;  // parameters of the rest shape

  long steps_ = 0;
};

}  // namespace

Schema pose_controller_schema() {
  return object(
             "Takes an example pose, holds it and leaves it, whatever comes of it. It ends when it has left "
             "the pose.")
      .field("example", string("Name of the example.").required())
      .field("take_s", number("Time to take the pose.").unit("s").above(0).initially(0.5))
      .field("hold_s", number("Time to hold it.").unit("s").at_least(0).initially(1))
      .field("leave_s", number("Time to leave it.").unit("s").above(0).initially(0.5));
}

std::unique_ptr<Controller> make_pose_controller(const ControlledBody& body, const Value& settings) {
  std::vector<Error> errors;
  check_example(settings, "the controller", body.examples, errors);
  if (!errors.empty()) throw errors.front();
  const auto found = std::find(body.examples.begin(), body.examples.end(), settings["example"].as_string());
  return std::make_unique<PoseController>(body, settings, found - body.examples.begin());
}

void check_example(const Value& settings, const std::string& where, std::span<const std::string> names,
                   std::vector<Error>& errors) {
  if (!settings.has("example")) return;
  const Value& example = settings["example"];
  if (std::find(names.begin(), names.end(), example.as_string()) != names.end()) return;
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  errors.emplace_back(ErrorKind::usage,
                      where + ".example = " + example.as_string() + ": the body has no such example",
                      list.empty() ? "give its rest_space examples" : "it has " + list, example.where());
}

}  // namespace vivify::sim
