// Goals as the scene gives them, (6)–(10): a controller written in YAML.
#pragma once

#include "sim/control/controller.h"

namespace vivify::sim {

Schema goals_controller_schema();
std::unique_ptr<Controller> make_goals_controller(const ControlledBody& body, const Value& settings);

}  // namespace vivify::sim
