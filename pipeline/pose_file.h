// Pose files: handles that take hold of a body and bring it into an example pose (sim/pose.h).
#pragma once

#include <filesystem>
#include <vector>

#include "common/error.h"
#include "common/mesh.h"
#include "common/schema.h"
#include "common/value.h"
#include "sim/pose.h"

namespace vivify::pipeline {

// The schema of a pose file.
Schema pose_schema();

// Reads a pose file, fills in defaults and checks what can be seen without its scene. Adds one Error(usage)
// per problem to `errors`; the result is whole when there is none. Throws Error(io) when the file cannot be
// read.
Value load_pose(const std::filesystem::path& file, std::vector<Error>& errors);

// The pose that a pose file (resolved with pose_schema) asks of the simulation mesh `rest`, as placed in the
// scene, with the elastic model `model`. `gravity` acts when the file says so. Errors name the place in the
// file.
sim::PoseSolution solve_pose(const Value& pose, const SimMesh& rest, const Value& model,
                             const Eigen::Vector3d& gravity);

// The points of a mesh moved back from the world to the coordinates of the asset of `body`; bodies of the
// plane come back with z = 0.
Points in_asset_coordinates(const RowMatrixXd& V, const Value& body);

}  // namespace vivify::pipeline
