// Pushes of a body in the scene file: their schema, what can be wrong with them, and how they are made.
#pragma once

#include <string>
#include <vector>

#include "common/error.h"
#include "common/schema.h"
#include "common/value.h"
#include "sim/push.h"

namespace vivify::pipeline {

Schema push_schema();

// Adds one Error(usage) per push of the body at `where` ("bodies[0]") that begins before the body appears, or
// leads out of the plane in which a `planar` body moves.
void check_pushes(const Value& body, const std::string& where, bool planar, std::vector<Error>& errors);

std::vector<sim::Push> make_pushes(const Value& body);

}  // namespace vivify::pipeline
