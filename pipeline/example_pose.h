// Example poses of a body, from meshes or pose files.
#pragma once

#include <string>

#include "common/mesh.h"
#include "common/value.h"
#include "pipeline/scene_file.h"

namespace vivify::pipeline {

// The pose (#V by d, in the world) that `example`, an item of the examples of `body`, gives the simulation
// mesh `rest`. Throws Error(geometry) when the file does not hold a pose of that mesh, and what solve_pose()
// throws.
RowMatrixXd example_pose(const Scene& scene, const Value& body, const Value& example, const SimMesh& rest);

// Its name in messages.
std::string example_name(const Value& example);

}  // namespace vivify::pipeline
