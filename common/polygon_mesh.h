// A mesh as a file gives it: polygons of any size, vertices not joined yet. Between the readers and
// read_mesh.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/file.h"

namespace vivify {

struct PolygonMesh {
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector2d> texture;  // one per point, or empty
  std::vector<std::vector<long>> faces;  // indices into points, not checked yet
  std::string part;                      // name of the material
};

// The faces of an ASCII or binary PLY file. Throws Error(geometry) that says what is wrong with the file.
PolygonMesh read_ply(const std::string& file_name, const Bytes& content);

// The meshes of any file that assimp reads, node transforms applied. Throws Error(geometry).
std::vector<PolygonMesh> read_with_assimp(const std::string& file_name);

// Cuts the polygon with the given corners (counted from 0, at least 3) into corners − 2 triangles of the same
// orientation, by clipping ears in the plane of its area vector.
std::vector<Eigen::Vector3i> triangulate(const std::vector<Eigen::Vector3d>& corners);

}  // namespace vivify
