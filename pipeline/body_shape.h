// What a body is made of: the mesh that is simulated, and the surface that is drawn and moves with it.
#pragma once

#include <string>
#include <vector>

#include "common/hdf5_file.h"
#include "common/mesh.h"
#include "common/value.h"
#include "meshing/outline.h"
#include "meshing/skin.h"
#include "pipeline/scene_file.h"

namespace vivify::pipeline {

struct BodyShape {
  SimMesh mesh;
  TriangleMesh surface;  // as drawn at rest, in the world
  meshing::Skin skin;
  TriangleMesh closed;             // solids: the repaired surface
  std::string route;               // solids: how it was repaired
  std::vector<std::string> notes;  // in plain words
};

// The shape of a body in the world. Throws Error(geometry) or Error(usage).
BodyShape make_body_shape(const Scene& scene, const Value& body);

// How the drawn surface of a body follows its simulation mesh, from its mesh/BODY.h5.
meshing::Skin load_skin(const Hdf5Reader& file);

// The outline of a body of the plane, in the world; without loops when it is an open line.
meshing::Outline placed_outline(const Scene& scene, const Value& body);

// Files that the settings of a body's shape name, for cache keys.
std::vector<std::filesystem::path> shape_files(const Scene& scene, const Value& body);

}  // namespace vivify::pipeline
