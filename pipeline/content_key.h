// Keys of the stage cache: hashes of everything that the content of a file depends on.
#pragma once

#include <filesystem>
#include <string>

#include "common/hash.h"
#include "common/value.h"

namespace vivify::pipeline {

// Builds one key. It begins with the revision of the sources that make the content (module is "meshing",
// "sim" or "render"), so that a changed program never takes over the files of another one.
class ContentKey {
 public:
  explicit ContentKey(const std::string& module);

  ContentKey& add(const std::string& name, const Value& setting);
  ContentKey& add(const std::string& name, const std::string& text);
  ContentKey& add(const std::string& name, long number);
  // The content of a file. Throws Error(io).
  ContentKey& add_file(const std::filesystem::path& path);
  // The content of a mesh file and of the files that it refers to (buffers of a glTF, materials of an OBJ).
  // Throws Error(io).
  ContentKey& add_mesh_file(const std::filesystem::path& path);

  std::string hex() const { return hasher_.hex(); }

 private:
  Hasher hasher_;
};

}  // namespace vivify::pipeline
