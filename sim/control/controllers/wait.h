// Standing still and upright.
#pragma once

#include "sim/control/controller.h"

namespace vivify::sim {

Schema wait_controller_schema();
std::unique_ptr<Controller> make_wait_controller(const ControlledBody& body, const Value& settings);

}  // namespace vivify::sim
