// A YAML file as a tree that keeps the line and column of every key and value.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/error.h"

namespace vivify {

struct ConfigNode {
  enum class Kind { null, scalar, list, map };
  struct Entry;

  Kind kind = Kind::null;
  std::string scalar;         // text of a scalar
  bool quoted = false;        // '5' is a string, 5 is a number
  std::vector<ConfigNode> items;
  std::vector<Entry> entries;
  Location where;
};

struct ConfigNode::Entry {
  std::string key;
  Location key_where;
  ConfigNode value;
};

// Parses YAML text. Adds one Error(usage) per problem to `errors`, each with file, line and column: syntax errors,
// duplicate keys, a second document, self-referencing anchors, merge keys (<<), octal numbers such as 010, YAML tags,
// bombs. The tree is still worth checking afterwards, so that all errors come in one go; when the text is no YAML at all
// it is a null without a place, which resolve() passes over.
ConfigNode parse_yaml(const std::string& text, const std::string& file_name, std::vector<Error>& errors);

// Applies `path.to.key=value` (lists by index: bodies.0.material.density=900 or bodies[0].…; a list of named maps also
// by name: bodies.cup.material.density=900). The value is YAML. Missing maps on the way are made. Places of the new
// nodes read "--set". Throws Error(usage) when the path does not fit the tree.
void apply_override(ConfigNode& root, const std::string& assignment);

}  // namespace vivify
