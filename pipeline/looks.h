// What the parts of the meshes look like: materials by the names of the scene, or those of the asset files.
#pragma once

#include <string>
#include <vector>

#include "common/schema.h"
#include "common/value.h"
#include "pipeline/scene_file.h"
#include "render/scene.h"

namespace vivify::pipeline {

// The key `looks` of a body, collider or prop.
Schema looks_schema();

// Throws Error(usage) when the `looks` of an object name a part that its mesh does not have.
void check_looks(const Value& item, const std::vector<std::string>& part_names);

// Throws Error(geometry) when the file of an object's mesh is broken, or needs an image that does not exist.
void check_asset_looks(const Scene& scene, const Value& item);

// The lights and materials that the scene is drawn with: its own, those of the glTF and GLB files of objects
// with parts that `looks` leaves out, and a grey. Throws Error(geometry) for a broken file.
render::Looks scene_looks(const Scene& scene);

// Material of each part of an object's mesh, by name in `looks`, the result of scene_looks: the one that the
// scene gives the part, or `all`, or the one of the file, or grey. A mesh without named parts has one part.
// Throws like check_looks.
std::vector<std::string> part_materials(const Value& item, const std::vector<std::string>& part_names,
                                        const render::Looks& looks);

}  // namespace vivify::pipeline
