// Keyframes of colliders and handles.
#pragma once

#include <string>
#include <vector>

#include "common/error.h"
#include "common/schema.h"
#include "common/value.h"
#include "sim/contact/rigid_path.h"

namespace vivify::pipeline {

// Adds the keys `motion` and `repeat_motion`; `what` moves ("object"). Each keyframe has the place under the
// key `place`, in metres, and a rotation, described by `turns`.
Schema add_motion(Schema object, const std::string& what, const std::string& place,
                  const Schema& place_schema, const std::string& turns);

bool moves(const Value& item);

// Adds an Error(usage) when a motion that is not there is to be repeated.
void check_motion(const Value& item, const std::string& where, std::vector<Error>& errors);

// The path of `item`, whose settings are at `where` ("colliders[0]"). Keyframes without a place have
// `otherwise`. Throws Error(usage) with the place of a keyframe that jumps.
sim::RigidPath motion_path(const Value& item, const std::string& where, const std::string& place,
                           const Eigen::Vector3d& otherwise);

}  // namespace vivify::pipeline
