#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <Eigen/LU>
#include <algorithm>
#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <mutex>

#include "common/error.h"
#include "common/polygon_mesh.h"

namespace vivify {
namespace {

// What assimp says while it lives: some broken files are read with wrong or missing faces and only a message.
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

std::string part_name(const aiScene& scene, const aiMesh& mesh) {
  aiString name;
  if (mesh.mMaterialIndex < scene.mNumMaterials) name = scene.mMaterials[mesh.mMaterialIndex]->GetName();
  const std::string text = name.C_Str();
  return text == AI_DEFAULT_MATERIAL_NAME ? "" : text;
}

PolygonMesh converted(const aiScene& scene, const aiMesh& mesh, const Eigen::Matrix4d& transform) {
  PolygonMesh result;
  result.part = part_name(scene, mesh);
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D& v = mesh.mVertices[i];
    const Eigen::Vector4d local(static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z),
                                1);
    result.points.emplace_back((transform * local).head<3>());
  }
  if (mesh.HasTextureCoords(0)) {
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D& t = mesh.mTextureCoords[0][i];
      result.texture.emplace_back(static_cast<double>(t.x), static_cast<double>(t.y));
    }
  }
  const bool mirrors = transform.topLeftCorner<3, 3>().determinant() < 0;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    result.faces.emplace_back(face.mIndices, face.mIndices + face.mNumIndices);
    if (mirrors) std::reverse(result.faces.back().begin(), result.faces.back().end());
  }
  return result;
}

void collect(const aiScene& scene, const aiNode& node, const Eigen::Matrix4d& parent,
             std::vector<PolygonMesh>& meshes) {
  Eigen::Matrix4d local;
  for (unsigned row = 0; row < 4; ++row) {
    for (unsigned col = 0; col < 4; ++col)
      local(row, col) = static_cast<double>(node.mTransformation[row][col]);
  }
  const Eigen::Matrix4d transform = parent * local;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    meshes.push_back(converted(scene, *scene.mMeshes[node.mMeshes[i]], transform));
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) collect(scene, *node.mChildren[i], transform, meshes);
}

}  // namespace

std::vector<PolygonMesh> read_with_assimp(const std::string& file_name) {
  const AssimpMessages messages;
  Assimp::Importer importer;
  // No post-processing: the triangulation of assimp 5.2 aborts the program when a mesh mixes triangles and
  // lines.
  const aiScene* const scene = importer.ReadFile(file_name, 0);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    throw Error(ErrorKind::geometry, file_name + " cannot be read as a mesh: " + importer.GetErrorString(),
                "export the asset again");
  }
  if (messages.speak_of("out of range") || messages.speak_of("out-of-range")) {
    throw Error(ErrorKind::geometry, file_name + " is broken: a face refers to a vertex that does not exist",
                "export the asset again");
  }
  std::vector<PolygonMesh> meshes;
  collect(*scene, *scene->mRootNode, Eigen::Matrix4d::Identity(), meshes);
  return meshes;
}

}  // namespace vivify
