// No goals: the body is passive, and only its own elasticity, gravity and contact move it.
#pragma once

#include "sim/control/controller.h"

namespace vivify::sim {

Schema rest_controller_schema();
std::unique_ptr<Controller> make_rest_controller(const ControlledBody& body, const Value& settings);

}  // namespace vivify::sim
