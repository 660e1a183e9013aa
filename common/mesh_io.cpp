#include "common/mesh_io.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <bit>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <new>
#include <unordered_map>

#include "common/error.h"
#include "common/file.h"
#include "common/rng.h"
#include "common/text.h"

namespace vivify {
namespace {

const std::vector<std::string> kExtensions = {".obj", ".ply", ".off", ".stl", ".gltf", ".glb"};

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what,
                       const std::string& hint = {}) {
  throw Error(ErrorKind::geometry, path.string() + " " + what, hint);
}

std::string point_text(double x, double y, double z) {
  return "(" + number_text(x) + ", " + number_text(y) + ", " + number_text(z) + ")";
}

// A vertex by the bits of its position and texture coordinates.
using VertexKey = std::array<std::uint64_t, 5>;
struct VertexKeyHash {
  std::size_t operator()(const VertexKey& k) const {
    return static_cast<std::size_t>(hash_words(k[0], k[1], k[2], k[3], k[4]));
  }
};

// A mesh of the file under one of the nodes that show it.
struct Instance {
  const aiMesh* mesh;
  Eigen::Matrix4d transform;
};

void collect_instances(const aiScene& scene, const aiNode& node, const Eigen::Matrix4d& parent,
                       std::vector<Instance>& instances) {
  Eigen::Matrix4d local;
  for (unsigned row = 0; row < 4; ++row) {
    for (unsigned col = 0; col < 4; ++col)
      local(row, col) = static_cast<double>(node.mTransformation[row][col]);
  }
  const Eigen::Matrix4d transform = parent * local;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    const aiMesh* const mesh = scene.mMeshes[node.mMeshes[i]];
    const auto is_triangle = [](const aiFace& face) { return face.mNumIndices == 3; };
    if (std::any_of(mesh->mFaces, mesh->mFaces + mesh->mNumFaces, is_triangle))
      instances.push_back({mesh, transform});
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i)
    collect_instances(scene, *node.mChildren[i], transform, instances);
}

std::string part_name(const aiScene& scene, const aiMesh& mesh) {
  aiString name;
  if (mesh.mMaterialIndex < scene.mNumMaterials) name = scene.mMaterials[mesh.mMaterialIndex]->GetName();
  const std::string text = name.C_Str();
  return text.empty() || text == AI_DEFAULT_MATERIAL_NAME ? "default" : text;
}

// Gathers vertices and faces, joining vertices that agree in position and texture coordinate.
class MeshBuilder {
 public:
  MeshBuilder(const std::filesystem::path& path, bool with_texture)
      : path_(path), with_texture_(with_texture) {}

  void add(const Instance& instance, int part) {
    const aiMesh& mesh = *instance.mesh;
    const bool mirrors = instance.transform.topLeftCorner<3, 3>().determinant() < 0;
    std::vector<int> joined(mesh.mNumVertices);
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) joined[i] = add_vertex(mesh, instance.transform, i);
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;
      std::array<int, 3> corners;
      for (unsigned k = 0; k < 3; ++k) {
        if (face.mIndices[k] >= mesh.mNumVertices) {
          fail(path_, "is broken: triangle " + std::to_string(parts_.size()) + " refers to vertex " +
                          std::to_string(face.mIndices[k]) + ", but there are " +
                          std::to_string(mesh.mNumVertices));
        }
        corners[k] = joined[face.mIndices[k]];
      }
      if (mirrors) std::swap(corners[1], corners[2]);
      triangles_.push_back(corners);
      parts_.push_back(part);
    }
    vertices_read_ += mesh.mNumVertices;
  }

  // Vertices that no triangle uses are left out; the order of the others is that of the file.
  TriangleMesh finish(std::vector<std::string> part_names) const {
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
    mesh.part_names = std::move(part_names);
    return mesh;
  }

 private:
  int add_vertex(const aiMesh& mesh, const Eigen::Matrix4d& transform, unsigned i) {
    const aiVector3D& v = mesh.mVertices[i];
    const Eigen::Vector4d local(static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z),
                                1);
    const Eigen::RowVector3d point = (transform * local).head<3>().transpose().array() + 0.0;  // no −0
    Eigen::RowVector2d uv = Eigen::RowVector2d::Zero();
    if (with_texture_) {
      const aiVector3D& t = mesh.mTextureCoords[0][i];
      uv = Eigen::RowVector2d(static_cast<double>(t.x), static_cast<double>(t.y)).array() + 0.0;
    }
    if (!point.allFinite()) {
      fail(path_,
           "has a vertex that is not finite: vertex " + std::to_string(vertices_read_ + i) + " is " +
               point_text(point.x(), point.y(), point.z()),
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
  std::vector<Eigen::RowVector3d> points_;
  std::vector<Eigen::RowVector2d> texture_;
  std::vector<std::array<int, 3>> triangles_;
  std::vector<int> parts_;
  std::size_t vertices_read_ = 0;
};

// What assimp says while it lives: some broken files are read with wrong or missing triangles and only a
// message.
class AssimpMessages final : public Assimp::LogStream {
 public:
  AssimpMessages() : lock_(mutex()) {
    Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
    Assimp::DefaultLogger::get()->attachStream(this, Assimp::Logger::Warn | Assimp::Logger::Err);
  }
  ~AssimpMessages() override {
    Assimp::DefaultLogger::get()->detachStream(this);  // it would be deleted otherwise
    Assimp::DefaultLogger::kill();
  }

  void write(const char* message) override { text_ += message; }
  bool speak_of(const std::string& words) const { return text_.find(words) != std::string::npos; }

 private:
  // The logger of assimp is one for the whole process.
  static std::mutex& mutex() {
    static std::mutex instance;
    return instance;
  }

  std::scoped_lock<std::mutex> lock_;
  std::string text_;
};

TriangleMesh read_checked(const std::filesystem::path& path) {
  const AssimpMessages messages;
  Assimp::Importer importer;
  const aiScene* const scene = importer.ReadFile(path.string(), aiProcess_Triangulate);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    fail(path, "cannot be read as a mesh: " + std::string(importer.GetErrorString()),
         "export the asset again");
  }
  if (messages.speak_of("out of range") || messages.speak_of("out-of-range")) {
    fail(path, "is broken: a face refers to a vertex that does not exist", "export the asset again");
  }
  std::vector<Instance> instances;
  collect_instances(*scene, *scene->mRootNode, Eigen::Matrix4d::Identity(), instances);
  if (instances.empty()) fail(path, "holds no triangle");
  const bool with_texture = std::all_of(instances.begin(), instances.end(),
                                        [](const Instance& i) { return i.mesh->HasTextureCoords(0); });
  MeshBuilder builder(path, with_texture);
  std::vector<std::string> part_names;
  for (const Instance& instance : instances) {
    const std::string name = part_name(*scene, *instance.mesh);
    const auto found = std::find(part_names.begin(), part_names.end(), name);
    const auto part = static_cast<int>(found - part_names.begin());
    if (found == part_names.end()) part_names.push_back(name);
    builder.add(instance, part);
  }
  return builder.finish(std::move(part_names));
}

}  // namespace

TriangleMesh read_mesh(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  if (!std::filesystem::exists(path)) {
    throw Error(ErrorKind::io, "mesh file " + path.string() + " does not exist",
                "paths are relative to the scene file");
  }
  if (std::find(kExtensions.begin(), kExtensions.end(), extension) == kExtensions.end()) {
    fail(path, "has an unknown mesh format '" + extension + "'", "known: " + join_words(kExtensions));
  }
  if (read_file(path).empty()) fail(path, "is empty");  // or cannot be read, which throws Error(io)
  try {
    return read_checked(path);
  } catch (const std::bad_alloc&) {
    fail(path, "is too large for the memory, or its header is broken");
  }
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
