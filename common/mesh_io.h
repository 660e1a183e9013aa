// Reading and writing surface meshes.
#pragma once

#include <filesystem>

#include "common/mesh.h"

namespace vivify {

// Reads OBJ, OFF, STL, glTF and GLB (through assimp) or PLY: triangulated, node transforms applied, points
// and lines dropped. Parts are the materials of the file by name, "default" where it names none; texture
// coordinates (origin at the lower left) are kept when every mesh of the file has them. Vertices are joined
// only where position and texture coordinate agree. Throws Error(io) when the file is missing or cannot be
// read, and Error(geometry) when its content is broken, it holds no triangle, a vertex that is not finite
// (its index is named), or an index out of range.
TriangleMesh read_mesh(const std::filesystem::path& path);

// All vertices of a PLY file in the order of the file (#V by 3), whatever else it holds. Throws like read_mesh.
Points read_ply_vertices(const std::filesystem::path& path);

// Writes a binary little-endian PLY (positions and triangles).
void write_ply(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace vivify
