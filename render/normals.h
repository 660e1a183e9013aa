// Shading normals of a deforming surface.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/vec.h"

namespace vivify::render {

// Unit normals at the corners of every triangle (3 #F): the mean, by angle, of the faces around the corner's
// place that are within `crease` (radians) of the corner's own face. Corners at the same place count as
// joined even where the mesh is split (seams of the texture). Faces without area get their neighbours'
// normals, else +y.
std::vector<Vec3> corner_normals(const std::vector<Vec3>& points,
                                 const std::vector<std::array<std::uint32_t, 3>>& triangles, float crease);

}  // namespace vivify::render
