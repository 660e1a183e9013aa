// A scene that runs in a second: a soft ball hops on a plate, a few frames of a few pixels.
#pragma once

#include <filesystem>
#include <string>

#include "common/mesh.h"
#include "tests/common/temporary_folder.h"

namespace vivify::testing_support {

// A closed box from −half to half, outward.
TriangleMesh box_mesh(const Eigen::Vector3d& half);

// A sphere around the origin from a refined octahedron, outward.
TriangleMesh ball_mesh(double radius, int refinements);

// Wavefront OBJ text of a mesh.
std::string obj_text(const TriangleMesh& mesh);

class TinyScene {
 public:
  TinyScene();

  // The scene file; rewritten with `text` replaced once by `replacement` (throws when it does not occur).
  const std::filesystem::path& file() const { return file_; }
  void change(const std::string& text, const std::string& replacement);
  void write(const std::string& name, const std::string& content) const;  // a file beside it

  std::filesystem::path folder() const { return folder_.path(); }
  std::filesystem::path out(const std::string& name = "out") const { return folder_ / name; }

 private:
  TemporaryFolder folder_;
  std::filesystem::path file_;
};

}  // namespace vivify::testing_support
