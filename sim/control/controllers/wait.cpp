#include "sim/control/controllers/wait.h"

#include <Eigen/Geometry>

#include "sim/control/body_goals.h"
#include "sim/control/rigid_motion.h"

namespace vivify::sim {
namespace {

constexpr double kFrequency = 4;         // ω of the goals of place, 1/s (k_p = ω k_d)
constexpr double kUprightFrequency = 8;  // wanted turning rate per radian of tilt, 1/s
constexpr double kUprightWeight = 10;    // of the goals that turn the body upright, relative to its inertia

// Stays where it touched the ground first; in flight nothing is asked.
class WaitController final : public Controller {
 public:
  WaitController(const ControlledBody& body, const Value& settings)
      : body_(body), effort_(settings["effort"].as_number()), rest_rise_(rest_rise(body)) {}

  std::vector<Goal> goals(const Observation& now) override {
    standing_ = stands(body_, now.load);
    if (now.ground) ground_ = *now.ground;
    place_ += body_.h * ground_;
    if (!standing_) return {};
    const Eigen::Vector3d centre = centre_of_mass(body_.mass, now.x);
    if (!begun_) {
      begun_ = true;
      place_ = centre;
      place_.y() = lowest_height(now.x, body_.dimension()) + rest_rise_;
    }
    BodyGoals goals(body_, now.x);
    for (int axis = 0; axis < 3; ++axis)
      goals.centre(Eigen::Vector3d::Unit(axis), effort_, kFrequency, place_[axis], ground_[axis]);
    const Eigen::Matrix3d R = best_rotation(body_.mass, body_.rest, now.x);
    goals.spin(effort_ * kUprightWeight, upright_rate(R, kUprightFrequency));
    return goals.take();
  }

  bool arrived() const override { return begun_; }
  std::string phase() const override { return standing_ ? "stand" : "flight"; }

  Eigen::VectorXd state() const override {
    Eigen::VectorXd state(8);
    state << standing_, begun_, place_, ground_;
    return state;
  }
  void restore(const Eigen::VectorXd& state) override {
    standing_ = state[0] != 0;
    begun_ = state[1] != 0;
    place_ = state.segment<3>(2);
    ground_ = state.segment<3>(5);
  }

 private:
  ControlledBody body_;
  double effort_;
  double rest_rise_;  // of the centre of mass above the lowest vertex at rest, m

  bool standing_ = false, begun_ = false;
  Eigen::Vector3d place_ = Eigen::Vector3d::Zero();   // of the centre of mass, goes along with the ground, m
  Eigen::Vector3d ground_ = Eigen::Vector3d::Zero();  // its velocity when it was touched last, m/s
};

}  // namespace

Schema wait_controller_schema() {
  return object("Stands still and upright where it is.")
      .field(
          "effort",
          number("Weight of the goals against the cost of changing the rest shape.").above(0).initially(0.3));
}

std::unique_ptr<Controller> make_wait_controller(const ControlledBody& body, const Value& settings) {
  return std::make_unique<WaitController>(body, settings);
}

}  // namespace vivify::sim
