// How a body of space moves besides travelling: it leans from side to side, it winds about the vertical.
#pragma once

#include <string>

#include "tests/pipeline/scene_result.h"

namespace vivify::testing_support {

// Root mean square over the frames, about the mean, of the angle by which the body leans to its left.
double sway_deg(const SceneResult& run, const std::string& body);
// The same of the angle about the vertical by which its upper third is turned against its lower third.
double twist_deg(const SceneResult& run, const std::string& body);

}  // namespace vivify::testing_support
