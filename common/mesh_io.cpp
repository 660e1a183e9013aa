#include "common/mesh_io.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <new>
#include <unordered_map>

#include "common/error.h"
#include "common/file.h"
#include "common/polygon_mesh.h"
#include "common/rng.h"
#include "common/text.h"

namespace vivify {
namespace {

const std::vector<std::string> kExtensions = {".obj", ".ply", ".off", ".stl", ".gltf", ".glb"};

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what,
                       const std::string& hint = {}) {
  throw Error(ErrorKind::geometry, path.string() + " " + what, hint);
}

// In small letters. Throws Error(io) when there is no such file.
std::string extension_of(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) {
    throw Error(ErrorKind::io, "mesh file " + path.string() + " does not exist",
                "paths are relative to the scene file");
  }
  std::string extension = path.extension().string();
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return extension;
}

// A vertex by the bits of its position and texture coordinates.
using VertexKey = std::array<std::uint64_t, 5>;
struct VertexKeyHash {
  std::size_t operator()(const VertexKey& k) const {
    return static_cast<std::size_t>(hash_words(k[0], k[1], k[2], k[3], k[4]));
  }
};

// Gathers vertices and triangles, joining vertices that agree in position and texture coordinate.
class MeshBuilder {
 public:
  MeshBuilder(const std::filesystem::path& path, bool with_texture)
      : path_(path), with_texture_(with_texture) {}

  void add(const PolygonMesh& source) {
    std::vector<int> joined;
    for (std::size_t i = 0; i < source.points.size(); ++i) joined.push_back(add_vertex(source, i));
    const int part = part_index(source.part.empty() ? "default" : source.part);
    std::vector<Eigen::Vector3d> corners;
    for (std::size_t f = 0; f < source.faces.size(); ++f) {
      const std::vector<long>& face = source.faces[f];
      corners.clear();
      for (const long v : face) {
        if (v < 0 || static_cast<std::size_t>(v) >= source.points.size()) {
          fail(path_,
               "is broken: face " + std::to_string(f) + " refers to vertex " + std::to_string(v) +
                   ", but there are " + std::to_string(source.points.size()),
               "indices count from 0; export the asset again");
        }
        corners.push_back(source.points[static_cast<std::size_t>(v)]);
      }
      if (face.size() < 3) continue;  // a point or a line
      for (const Eigen::Vector3i& triangle : triangulate(corners)) {
        std::array<int, 3> indices;
        for (std::size_t k = 0; k < 3; ++k) {
          const long v = face[static_cast<std::size_t>(triangle[static_cast<Eigen::Index>(k)])];
          indices[k] = joined[static_cast<std::size_t>(v)];
        }
        triangles_.push_back(indices);
        parts_.push_back(part);
      }
    }
    vertices_read_ += source.points.size();
  }

  // Vertices that no triangle uses are left out; the order of the others is that of the file.
  TriangleMesh finish() {
    if (triangles_.empty()) fail(path_, "holds no triangle");
    std::vector<int> index(points_.size(), -1);
    for (const auto& triangle : triangles_) {
      for (const int v : triangle) index[static_cast<std::size_t>(v)] = 0;
    }
    int used = 0;
    for (int& i : index) {
      if (i == 0) i = used++;
    }
    TriangleMesh mesh;
    mesh.V.resize(used, 3);
    if (with_texture_) mesh.UV.resize(used, 2);
    for (std::size_t v = 0; v < points_.size(); ++v) {
      if (index[v] < 0) continue;
      mesh.V.row(index[v]) = points_[v];
      if (with_texture_) mesh.UV.row(index[v]) = texture_[v];
    }
    const auto face_count = static_cast<Eigen::Index>(triangles_.size());
    mesh.F.resize(face_count, 3);
    mesh.face_part.resize(face_count);
    for (Eigen::Index f = 0; f < face_count; ++f) {
      const auto& triangle = triangles_[static_cast<std::size_t>(f)];
      for (std::size_t k = 0; k < 3; ++k) {
        mesh.F(f, static_cast<Eigen::Index>(k)) = index[static_cast<std::size_t>(triangle[k])];
      }
      mesh.face_part(f) = parts_[static_cast<std::size_t>(f)];
    }
    mesh.part_names = std::move(part_names_);
    return mesh;
  }

 private:
  int part_index(const std::string& name) {
    const auto found = std::find(part_names_.begin(), part_names_.end(), name);
    const auto index = static_cast<int>(found - part_names_.begin());
    if (found == part_names_.end()) part_names_.push_back(name);
    return index;
  }

  int add_vertex(const PolygonMesh& source, std::size_t i) {
    const Eigen::Vector3d point = source.points[i].array() + 0.0;  // no −0
    Eigen::Vector2d uv = Eigen::Vector2d::Zero();
    if (with_texture_) uv = source.texture[i].array() + 0.0;
    if (!point.allFinite()) {
      fail(path_,
           "has a vertex that is not finite: vertex " + std::to_string(vertices_read_ + i) + " is (" +
               number_text(point.x()) + ", " + number_text(point.y()) + ", " + number_text(point.z()) + ")",
           "indices count from 0; export the asset again");
    }
    if (!uv.allFinite()) {
      fail(path_,
           "has a texture coordinate that is not finite, at vertex " + std::to_string(vertices_read_ + i),
           "indices count from 0; export the asset again");
    }
    const VertexKey key = {std::bit_cast<std::uint64_t>(point.x()), std::bit_cast<std::uint64_t>(point.y()),
                           std::bit_cast<std::uint64_t>(point.z()), std::bit_cast<std::uint64_t>(uv.x()),
                           std::bit_cast<std::uint64_t>(uv.y())};
    const auto [found, is_new] = known_.try_emplace(key, static_cast<int>(points_.size()));
    if (is_new) {
      points_.push_back(point);
      texture_.push_back(uv);
    }
    return found->second;
  }

  const std::filesystem::path& path_;
  bool with_texture_;
  std::unordered_map<VertexKey, int, VertexKeyHash> known_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<Eigen::Vector2d> texture_;
  std::vector<std::array<int, 3>> triangles_;
  std::vector<int> parts_;
  std::vector<std::string> part_names_;
  std::size_t vertices_read_ = 0;
};

}  // namespace

TriangleMesh read_mesh(const std::filesystem::path& path) {
  const std::string extension = extension_of(path);
  if (std::find(kExtensions.begin(), kExtensions.end(), extension) == kExtensions.end()) {
    fail(path, "has an unknown mesh format '" + extension + "'", "known: " + join_words(kExtensions));
  }
  const Bytes content = read_file(path);
  if (content.empty()) fail(path, "is empty");
  try {
    std::vector<PolygonMesh> meshes;
    if (extension == ".ply") {
      meshes.push_back(read_ply(path.string(), content));
    } else {
      meshes = read_with_assimp(path.string());
      std::erase_if(meshes, [](const PolygonMesh& mesh) {
        return std::none_of(mesh.faces.begin(), mesh.faces.end(),
                            [](const auto& face) { return face.size() >= 3; });
      });
    }
    const bool with_texture = std::all_of(meshes.begin(), meshes.end(),
                                          [](const PolygonMesh& mesh) { return !mesh.texture.empty(); });
    MeshBuilder builder(path, with_texture);
    for (const PolygonMesh& mesh : meshes) builder.add(mesh);
    return builder.finish();
  } catch (const std::bad_alloc&) {
    fail(path, "is too large for the memory, or its header is broken");
  }
}

Points read_ply_vertices(const std::filesystem::path& path) {
  if (extension_of(path) != ".ply") fail(path, "is no PLY file", "save its vertices as PLY");
  const PolygonMesh mesh = read_ply(path.string(), read_file(path));
  Points V(std::ssize(mesh.points), 3);
  for (Eigen::Index i = 0; i < V.rows(); ++i) {
    V.row(i) = mesh.points[static_cast<std::size_t>(i)].transpose();
    if (!V.row(i).allFinite()) fail(path, "has a vertex that is not finite: vertex " + std::to_string(i));
  }
  return V;
}

void write_ply(const std::filesystem::path& path, const TriangleMesh& mesh) {
  static_assert(std::endian::native == std::endian::little);
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(mesh.V.rows()) +
                     "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                     std::to_string(mesh.F.rows()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  const auto append = [&](const void* data, std::size_t bytes) {
    text.append(static_cast<const char*>(data), bytes);
  };
  append(mesh.V.data(), sizeof(double) * static_cast<std::size_t>(mesh.V.size()));
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    text += '\3';
    append(mesh.F.row(f).data(), 3 * sizeof(int));
  }
  write_file_atomic(path, text);
}

}  // namespace vivify
