// Turning about the vertical: small hops on the spot until the character looks where it shall.
#pragma once

#include <string>
#include <vector>

#include "sim/control/controller.h"

namespace vivify::sim {

Schema turn_controller_schema();
// Throws Error(usage) for what check_turn() finds, and without gravity.
std::unique_ptr<Controller> make_turn_controller(const ControlledBody& body, const Value& settings);

// Adds an Error(usage) for a turn of a body of the plane, and unless it is given one way. `where` is the path
// of the settings. Settings of other controllers pass.
void check_turn(const Value& settings, const std::string& where, bool planar, std::vector<Error>& errors);

}  // namespace vivify::sim
