// Taking an example pose, holding it and leaving it: the keyframes of `blend` that are asked for most, told
// by name, and from whatever rest shape there is.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "sim/control/controller.h"

namespace vivify::sim {

Schema pose_controller_schema();
std::unique_ptr<Controller> make_pose_controller(const ControlledBody& body, const Value& settings);

// Adds an Error(usage) when the settings name an example that is not one of `names`, those of the body.
// `where` is the path of the settings. Settings that name none pass.
void check_example(const Value& settings, const std::string& where, std::span<const std::string> names,
                   std::vector<Error>& errors);

}  // namespace vivify::sim
