// Walking on any number of feet: the centre of mass goes over the feet that stand, then another foot steps.
// Bodies of space rock from foot to foot.
#pragma once

#include "sim/control/controller.h"

namespace vivify::sim {

Schema walk_controller_schema();
std::unique_ptr<Controller> make_walk_controller(const ControlledBody& body, const Value& settings);

}  // namespace vivify::sim
