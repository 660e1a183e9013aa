// Meshes of the scene, put where the scene says.
#pragma once

#include <string>

#include "common/mesh.h"
#include "common/schema.h"
#include "pipeline/scene_file.h"

namespace vivify::pipeline {

// Keys of everything that is placed in the world: name, mesh, position, scale, heading_deg, looks.
Schema placed_schema(std::string doc, bool mesh_required);

// Turn about +Y by `heading_deg`.
Eigen::Matrix3d heading_rotation(const Value& item);

// Points (#V by 2 or 3) of an asset moved to the world: scale first, then heading, then position, as `item`
// (a body, collider or prop) says.
void place(const Value& item, Points& V);
// The same without the position.
void scale_and_turn(const Value& item, Points& V);
// In the plane there is no heading, and z has no effect.
void place(const Value& item, Points2& V);

// The mesh of a body, collider or prop, as in its file or in the world. Throws Error(geometry) for a mesh
// that cannot be read; the message names the object.
TriangleMesh read_asset(const Scene& scene, const Value& item);
TriangleMesh read_placed_mesh(const Scene& scene, const Value& item);

}  // namespace vivify::pipeline
