#include "pipeline/content_key.h"

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "common/file.h"
#include "common/gltf_file.h"
#include "pipeline/version.h"

namespace vivify::pipeline {
namespace {

// Files that a mesh file refers to, as it names them.
std::vector<std::string> companions(const std::filesystem::path& path) {
  std::vector<std::string> names;
  const std::string ending = path.extension().string();
  if (ending == ".gltf") {
    const nlohmann::json json = nlohmann::json::parse(read_text_file(path), nullptr, false);
    if (!json.is_object() || !json.contains("buffers") || !json["buffers"].is_array()) return names;
    for (const nlohmann::json& buffer : json["buffers"]) {
      if (!buffer.is_object() || !buffer.contains("uri") || !buffer["uri"].is_string()) continue;
      const std::string uri = buffer["uri"];
      if (!uri.starts_with("data:")) names.push_back(decode_uri(uri));
    }
  } else if (ending == ".obj") {
    std::istringstream lines(read_text_file(path));
    for (std::string line; std::getline(lines, line);) {
      if (!line.starts_with("mtllib ")) continue;
      const std::size_t first = line.find_first_not_of(" \t", 7), last = line.find_last_not_of(" \t\r");
      if (first != line.npos) names.push_back(line.substr(first, last + 1 - first));
    }
  }
  return names;
}

}  // namespace

ContentKey::ContentKey(const std::string& module) { hasher_.add(source_revision(module)); }

ContentKey& ContentKey::add(const std::string& name, const Value& setting) {
  return add(name, setting.yaml());
}

ContentKey& ContentKey::add(const std::string& name, const std::string& text) {
  hasher_.add(name).add(text);
  return *this;
}

ContentKey& ContentKey::add(const std::string& name, long number) {
  return add(name, std::to_string(number));
}

ContentKey& ContentKey::add_file(const std::filesystem::path& path) {
  // A run asks for the same few files in every stage; they are read once.
  static std::map<std::filesystem::path, std::string> known;
  auto found = known.find(path);
  if (found == known.end()) found = known.emplace(path, hash_hex(read_file(path))).first;
  hasher_.add("file").add(found->second);
  return *this;
}

ContentKey& ContentKey::add_mesh_file(const std::filesystem::path& path) {
  add_file(path);
  for (const std::string& name : companions(path)) {
    const std::filesystem::path companion = path.parent_path() / name;
    std::error_code ignored;
    add("companion", name);
    if (std::filesystem::is_regular_file(companion, ignored)) add_file(companion);
  }
  return *this;
}

}  // namespace vivify::pipeline
