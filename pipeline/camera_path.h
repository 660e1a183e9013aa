// How the camera goes with a body.
#pragma once

#include "common/mesh.h"

namespace vivify::pipeline {

// Displacements of the camera for every frame (#frames by 3, metres) that follow the path of a body's centre
// of mass
// (#frames by 3, metres): the path is smoothed with a Hann window that spans `window` frames (none below 2),
// continued beyond its ends by point reflection, so that steady motion is followed exactly and the first
// displacement is zero. The height is followed only on request.
Points camera_displacements(const Points& path, double window, bool follow_height);

}  // namespace vivify::pipeline
