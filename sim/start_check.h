// What must hold of the bodies of a world before their first step.
#pragma once

#include <memory>
#include <vector>

#include "sim/body.h"
#include "sim/contact/collider.h"

namespace vivify::sim {

// Contact pushes apart what starts a little inside something else: as far as 2 % of the height of the body,
// or of the smaller of two bodies. Throws Error(geometry) that names both and the depth for what starts
// deeper, and for thin bodies that start across another body: it would burst apart, or stay entangled. Moves
// the surfaces of the bodies to where they are.
void check_start(const std::vector<std::unique_ptr<Body>>& bodies, const std::vector<Collider>& colliders);

}  // namespace vivify::sim
