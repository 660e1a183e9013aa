// The direction in which a controller travels.
#pragma once

#include "sim/control/controller.h"

namespace vivify::sim {

// The setting `heading_deg`.
Schema heading_schema();

// Unit vector of `heading_deg` (of `settings`): 0° is +z, 90° is +x. Throws Error(usage) for a body of the
// plane that is not sent along x, and without gravity, which presses a body onto the ground that it travels
// on.
Eigen::Vector3d heading_of(const ControlledBody& body, const Value& settings);

}  // namespace vivify::sim
