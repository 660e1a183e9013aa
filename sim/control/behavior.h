// What the animator writes: a script of behaviours, one after the other. Each is a controller under its name:
//   - hop: {to: [2, 0, 1], height: 0.3}
//   - wait: {for_s: 1}
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "sim/control/controller.h"

namespace vivify::sim {

// The setting `behavior` of a body.
Schema behavior_schema();

// The bodies that a controller or behaviour with these settings looks at: the key, and the name as a text
// with its place in the file. Throws Error(usage) for a condition that cannot be read.
std::vector<std::pair<std::string, Value>> looked_at(const Value& settings);

// Goes through the script; the last behaviour goes on after its end. `body` must outlive it. Throws
// Error(usage) as its controllers do, and for a condition that cannot be read.
std::unique_ptr<Controller> make_script(const ControlledBody& body, const Value& behavior);

}  // namespace vivify::sim
