#include "pipeline/content_key.h"

#include <map>

#include "common/file.h"
#include "pipeline/version.h"

namespace vivify::pipeline {

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

}  // namespace vivify::pipeline
