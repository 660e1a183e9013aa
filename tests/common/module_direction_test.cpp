// The direction of the modules, read off the includes: common <- meshing, sim, render <- pipeline.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "common/file.h"

namespace vivify {
namespace {

namespace fs = std::filesystem;

const std::map<std::string, std::set<std::string>> kMayInclude = {
    {"common", {"common"}},
    {"meshing", {"common", "meshing"}},
    {"sim", {"common", "sim"}},
    {"render", {"common", "render"}},
    {"pipeline", {"common", "meshing", "sim", "render", "pipeline"}},
};

struct Include {
  fs::path file;  // relative to the root
  int line;
  std::string name;
  std::string place() const { return file.string() + ":" + std::to_string(line) + " includes " + name; }
};

std::vector<Include> includes_of(const std::string& module) {
  static const std::regex kInclude(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  const fs::path root = VIVIFY_SOURCE_DIR;
  std::vector<Include> includes;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / module)) {
    if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
    std::istringstream stream(read_text_file(entry.path()));
    std::smatch match;
    int line = 0;
    for (std::string text; std::getline(stream, text);) {
      ++line;
      if (std::regex_search(text, match, kInclude))
        includes.push_back({fs::relative(entry.path(), root), line, match[1]});
    }
  }
  return includes;
}

TEST(ModuleDirection, NobodyIncludesAgainstTheFlow) {
  for (const auto& [module, allowed] : kMayInclude) {
    int own = 0;
    for (const Include& include : includes_of(module)) {
      const std::string target = include.name.substr(0, include.name.find('/'));
      if (!kMayInclude.contains(target) || include.name.find('/') == std::string::npos) {
        EXPECT_NE(include.name.substr(0, 3), "../") << include.place();
        continue;
      }
      ++own;
      EXPECT_TRUE(allowed.contains(target)) << include.place();
    }
    EXPECT_GT(own, 3) << module << " was not scanned";
  }
}

TEST(ModuleDirection, EmbreeStaysInOneFile) {
  bool seen = false;
  for (const auto& [module, allowed] : kMayInclude) {
    for (const Include& include : includes_of(module)) {
      if (!include.name.starts_with("embree")) continue;
      seen = true;
      EXPECT_TRUE(include.file == "render/accel.h" || include.file == "render/accel.cpp") << include.place();
    }
  }
  EXPECT_TRUE(seen);
}

// A header called cgal_… is for the .cpp files that use CGAL anyway; no header includes it.
TEST(ModuleDirection, HeavyHeadersStayOutOfOurHeaders) {
  const std::regex heavy(
      R"(^(CGAL|CLI|spdlog|yaml-cpp|embree\d?|assimp|tbb)/|^nlohmann/json\.hpp|^hdf5\.h|^tetgen|/cgal_)");
  for (const auto& [module, allowed] : kMayInclude) {
    for (const Include& include : includes_of(module)) {
      if (include.file.extension() != ".h") continue;
      const bool for_cgal_only =
          include.file.filename().string().starts_with("cgal_") && include.name.starts_with("CGAL/");
      EXPECT_TRUE(for_cgal_only || !std::regex_search(include.name, heavy)) << include.place();
    }
  }
}

}  // namespace
}  // namespace vivify
