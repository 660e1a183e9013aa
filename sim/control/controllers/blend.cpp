#include "sim/control/controllers/blend.h"

#include "sim/control/keyed_weights.h"

namespace vivify::sim {
namespace {

class BlendController final : public Controller {
 public:
  BlendController(const ControlledBody& body, std::vector<WeightKey> keys, bool smooth)
      : poses_(body.poses), keys_(std::move(keys)), smooth_(smooth), h_(body.h) {}

  std::vector<Goal> goals(const Observation&) override {
    ++steps_;
    return {};
  }

  std::optional<Eigen::VectorXd> rest_parameters(double t) const override {
    return poses_ * weights_at(keys_, smooth_, t);
  }

  bool arrived() const override { return static_cast<double>(steps_) * h_ >= keys_.back().t; }
  std::string phase() const override { return "blend"; }
  Eigen::VectorXd state() const override { return Eigen::VectorXd::Constant(1, static_cast<double>(steps_)); }
  void restore(const Eigen::VectorXd& state) override { steps_ = static_cast<long>(state[0]); }

 private:
  Eigen::MatrixXd poses_;  // #p by #examples
  std::vector<WeightKey> keys_;
  bool smooth_;
  double h_;
  long steps_ = 0;
};

[[noreturn]] void fail(const Value& key, const std::string& message) {
  throw Error(ErrorKind::usage, message, "", key.where());
}

}  // namespace

Schema blend_controller_schema() {
  return object(
             "The rest shape follows keyframes, whatever comes of it, and has arrived at the last one. Each "
             "has a weight for each example of the rest space.")
      .field(
          "keys",
          list("The keyframes, in the order of time; in a script, time begins with the behaviour. Before the "
               "first and after the last the weights stay.",
               object("Weights at a time.")
                   .field("t", number("Time.").unit("s").at_least(0).required())
                   .field("weights",
                          list("Weight of each example, in their order: 0 is the shape of the body, 1 "
                               "the example.",
                               number("A weight."))
                              .items_at_least(1)
                              .required()))
              .items_at_least(1)
              .required())
      .field("between",
             choice("How the weights go from one keyframe to the next: at a constant rate, or slowly at "
                    "both ends.",
                    {"linear", "smooth"})
                 .initially("linear"));
}

std::unique_ptr<Controller> make_blend_controller(const ControlledBody& body, const Value& settings) {
  std::vector<WeightKey> keys;
  for (const Value& item : settings["keys"].items()) {
    WeightKey key = {item["t"].as_number(), item["weights"].as_vector()};
    if (!keys.empty() && !(key.t > keys.back().t)) fail(item, "controller.keys must be in the order of time");
    if (key.weights.size() != body.poses.cols()) {
      throw Error(ErrorKind::usage,
                  "the controller gives " + std::to_string(key.weights.size()) +
                      " weights and the rest space has " + std::to_string(body.poses.cols()) + " examples",
                  "give one weight per example", item["weights"].where());
    }
    keys.push_back(std::move(key));
  }
  return std::make_unique<BlendController>(body, std::move(keys),
                                           settings["between"].as_string() == "smooth");
}

}  // namespace vivify::sim
