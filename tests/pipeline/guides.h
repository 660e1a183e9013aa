// What the guides tell people to type.
#pragma once

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "common/file.h"

namespace vivify::testing_support {

// Contents of the fenced blocks of one language in a Markdown file.
inline std::vector<std::string> fenced_blocks(const std::filesystem::path& file,
                                              const std::string& language) {
  std::istringstream lines(read_text_file(file));
  std::vector<std::string> blocks;
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    if (!inside && line == "```" + language) {
      inside = true;
      blocks.emplace_back();
    } else if (inside && line == "```") {
      inside = false;
    } else if (inside) {
      blocks.back() += line + "\n";
    }
  }
  return blocks;
}

// The scenes of the guides, written to the folder configs/ of `clone` with the first line that they leave
// out, and the files beside them, which begin with their name.
inline std::vector<std::filesystem::path> write_guide_scenes(const std::filesystem::path& clone) {
  std::vector<std::filesystem::path> scenes;
  for (const char* guide : {"docs/user_guide.md", "docs/directing.md"}) {
    for (const std::string& block : fenced_blocks(std::filesystem::path(VIVIFY_SOURCE_DIR) / guide, "yaml")) {
      if (block.starts_with("# ")) {
        write_file_atomic(clone / "configs" / block.substr(2, block.find('\n') - 2), block);
        continue;
      }
      scenes.push_back(clone / "configs" / ("guide" + std::to_string(scenes.size()) + ".yaml"));
      write_file_atomic(scenes.back(), "version: 1\n" + block);
    }
  }
  return scenes;
}

}  // namespace vivify::testing_support
