// What must hold of the bodies of a world when they appear.
#pragma once

#include <vector>

#include "sim/contact/collider.h"
#include "sim/near_bodies.h"

namespace vivify::sim {

// Contact pushes apart what appears a little inside something else: as far as 2 % of the height of the body,
// or of the smaller of two bodies. Throws Error(geometry) that names both and the depth for what appears
// deeper, and for thin bodies that appear across another body: it would burst apart, or stay entangled.
// Checks the members that appear after the step `step` (0: at the start), at the time `time`, s. Moves the
// surfaces of the members to where they are.
void check_start(const std::vector<Member>& members, const std::vector<Collider>& colliders, long step,
                 double time);

}  // namespace vivify::sim
