// Reading and writing surface meshes.
#pragma once

#include <filesystem>

#include "common/mesh.h"

namespace vivify {

// Reads OBJ, PLY, OFF, STL, glTF or GLB (through assimp): triangulated, node transforms applied, points and lines
// dropped. Parts are the materials of the file, by name; texture coordinates are kept when every mesh of the file has
// them. Vertices are joined only where position and texture coordinate agree.
// Throws Error(io) when the file cannot be read and Error(geometry) when it holds no triangle, a non-finite vertex (its
// index is named), or an index out of range.
TriangleMesh read_mesh(const std::filesystem::path& path);

// Writes a binary little-endian PLY (positions and triangles).
void write_ply(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace vivify
