// Friction of pairs that the scene names.
#pragma once

#include <string>
#include <vector>

#include "common/error.h"
#include "common/schema.h"
#include "common/value.h"
#include "sim/contact/contact_set.h"

namespace vivify::pipeline {

// The list `friction` of a scene.
Schema friction_schema();

// Adds one Error(usage) per pair of the scene that does not name two things that can touch, or that was given
// before.
void check_friction(const Value& scene, std::vector<Error>& errors);

// Coulomb's μ of a body with what the scene names beside it.
sim::FrictionByName friction_of(const Value& scene, const std::string& body);

}  // namespace vivify::pipeline
