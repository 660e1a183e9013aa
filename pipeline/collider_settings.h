// Colliders of the scene file: their schema, how they are made, what they look like and how they move.
#pragma once

#include <string>
#include <vector>

#include "common/error.h"
#include "common/mesh.h"
#include "common/schema.h"
#include "common/value.h"
#include "pipeline/content_key.h"
#include "pipeline/scene_file.h"
#include "sim/contact/collider.h"

namespace vivify::pipeline {

Schema collider_schema();

// Adds one Error(usage) per setting of the collider at `where` ("colliders[0]") that does not fit the others.
void check_collider(const Value& collider, const std::string& where, std::vector<Error>& errors);

// The collider at `where`, in its own frame: the world, or for one that moves its asset with scale and
// heading. Throws Error(geometry) and Error(usage) with the place in the scene file.
sim::Collider make_collider(const Scene& scene, const Value& collider, const std::string& where);

// The surface to draw, in the same frame.
TriangleMesh collider_surface(const Scene& scene, const Value& collider);

// The path of the collider through the world.
sim::RigidPath collider_path(const Value& collider, const std::string& where);

// Adds all that says where the surface of a collider is at any time.
void add_collider_geometry(ContentKey& key, const Scene& scene, const Value& collider);

}  // namespace vivify::pipeline
