// Handles of a body in the scene file: their schema, what can be wrong with them, and how they are made.
#pragma once

#include <string>
#include <vector>

#include "common/error.h"
#include "common/schema.h"
#include "common/value.h"
#include "sim/handles.h"

namespace vivify::pipeline {

Schema handle_schema();

// Adds one Error(usage) per setting of the handles of the body at `where` ("bodies[0]") that does not fit.
// `planar`: the body moves in the plane.
void check_handles(const Value& body, const std::string& where, bool planar, std::vector<Error>& errors);

// The handles of the body at `where`. Throws Error(usage) with the place of a keyframe that jumps.
std::vector<sim::Handle> make_handles(const Value& body, const std::string& where);

}  // namespace vivify::pipeline
