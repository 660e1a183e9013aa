#include "sim/control/controllers/rest.h"

namespace vivify::sim {
namespace {

class RestController final : public Controller {
 public:
  std::vector<Goal> goals(const Observation&) override { return {}; }
  bool passive() const override { return true; }
  std::string phase() const override { return "rest"; }
  Eigen::VectorXd state() const override { return {}; }
  void restore(const Eigen::VectorXd&) override {}
};

}  // namespace

Schema rest_controller_schema() { return object("The body asks for nothing: a passive object."); }

std::unique_ptr<Controller> make_rest_controller(const ControlledBody&, const Value&) {
  return std::make_unique<RestController>();
}

}  // namespace vivify::sim
