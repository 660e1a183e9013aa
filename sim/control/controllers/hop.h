// Hopping: crouch, thrust, flight, land, over and over, along a heading. In flight nothing is asked of the
// centre of mass, which no internal force can move.
#pragma once

#include "sim/control/controller.h"

namespace vivify::sim {

Schema hop_controller_schema();
std::unique_ptr<Controller> make_hop_controller(const ControlledBody& body, const Value& settings);

}  // namespace vivify::sim
