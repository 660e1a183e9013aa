// What a glTF or GLB file says besides its mesh: the materials of its parts and the images they refer to.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/file.h"

namespace vivify {

// The metallic-roughness material of a part of a mesh.
struct PartLook {
  std::string part;                   // as in TriangleMesh::part_names
  Eigen::Vector3d color = {1, 1, 1};  // linear Rec. 709, 0 … 1
  double metallic = 1;                // 0 … 1
  double roughness = 1;               // 0 … 1
  std::optional<std::filesystem::path>
      texture;                           // image that multiplies the colour; relative to the mesh file
  std::optional<long> embedded_texture;  // or the number of an image inside the mesh file (GLB)
};

// The materials of a glTF 2.0 or GLB file, one for each name; none for files of other formats. Materials
// without metallic-roughness settings are left out. Where a texture tells metallic and roughness, the part
// counts as no metal. Throws Error(io) when the file cannot be read and Error(geometry) when it is broken.
std::vector<PartLook> read_part_looks(const std::filesystem::path& path);

// The image (PNG or JPEG) of this number inside a GLB file. Throws Error(io) when there is none.
Bytes read_embedded_image(const std::filesystem::path& path, long number);

// A name as it stands in a URI, in plain text: %20 is a space.
std::string decode_uri(const std::string& uri);

}  // namespace vivify
