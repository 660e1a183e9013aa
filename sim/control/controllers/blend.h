// Rest shapes by keyframes: the parameters p are prescribed over time, such as the weights of example poses,
// and the body follows as its elasticity lets it. Nothing is sought.
#pragma once

#include "sim/control/controller.h"

namespace vivify::sim {

Schema blend_controller_schema();
std::unique_ptr<Controller> make_blend_controller(const ControlledBody& body, const Value& settings);

}  // namespace vivify::sim
