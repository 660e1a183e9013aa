// Rolling: the centre of mass is to travel along a heading at a steady speed, and little else is asked. A
// goal for the spin makes rolling worse: how the body turns follows from friction.
#pragma once

#include "sim/control/controller.h"

namespace vivify::sim {

Schema roll_controller_schema();
std::unique_ptr<Controller> make_roll_controller(const ControlledBody& body, const Value& settings);

}  // namespace vivify::sim
