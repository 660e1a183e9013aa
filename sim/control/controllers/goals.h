// Goals as the scene gives them, (6)–(10): a controller written in YAML.
#pragma once

#include "sim/control/controller.h"

namespace vivify::sim {

Schema goals_controller_schema();

// Throws Error(usage) for what check_goals() finds, and for a region without vertices.
std::unique_ptr<Controller> make_goals_controller(const ControlledBody& body, const Value& settings);

// Adds an Error(usage) for directions of no length, for a constant value without frequency, for keys that are
// not in the order of time, and for those after the period. `where` is the path of the settings. Settings of
// other controllers pass.
void check_goals(const Value& settings, const std::string& where, std::vector<Error>& errors);

}  // namespace vivify::sim
