// How the camera goes with a body.
#pragma once

#include <filesystem>
#include <vector>

#include "common/mesh.h"
#include "common/value.h"
#include "render/scene.h"

namespace vivify::pipeline {

// Displacements of the camera for every frame (#frames by 3, metres) that follow the path of a body's centre
// of mass
// (#frames by 3, metres): the path is smoothed with a Hann window that spans `window` frames (none below 2),
// continued beyond its ends by point reflection, so that steady motion is followed exactly and the first
// displacement is zero. The height is followed only on request.
Points camera_displacements(const Points& path, double window, bool follow_height);

// The cameras of the first `frame_count` frames of a scene that was simulated in the folder `out`. For a body
// that appears later they wait where it will be. Throws
// Error(io) when frames that the camera follows are missing.
std::vector<render::Camera> frame_cameras(const Value& scene, const std::filesystem::path& out,
                                          int frame_count);

}  // namespace vivify::pipeline
