// What the documents tell people to type works.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <sstream>

#include "common/file.h"
#include "tests/common/temporary_folder.h"
#include "tests/pipeline/guides.h"
#include "tests/pipeline/program.h"

namespace vivify::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::fenced_blocks;
using testing_support::Outcome;
using testing_support::ProgramOptions;
using testing_support::TemporaryFolder;
using testing_support::vivify;
using testing_support::write_guide_scenes;

const fs::path kSource = VIVIFY_SOURCE_DIR;

// A folder that looks like a clone: the shipped assets and scenes, and the scene that the README tells people
// to save.
void make_clone(const TemporaryFolder& clone) {
  fs::create_directory_symlink(kSource / "assets", clone / "assets");
  fs::copy(kSource / "configs", clone / "configs");
  const std::vector<std::string> scenes = fenced_blocks(kSource / "README.md", "yaml");
  ASSERT_EQ(scenes.size(), 1u);
  write_file_atomic(clone / "configs/small.yaml", scenes[0]);
}

// Every command is typed in the clone. Those that would make pictures are asked for their plan only
// (--dry-run); sheet and diff have to say that the folders are not there yet.
TEST(Docs, EveryCommandWorks) {
  const TemporaryFolder clone;
  make_clone(clone);
  ProgramOptions options;
  options.folder = clone.path();
  int tried = 0;
  for (const char* file : {"README.md", "docs/user_guide.md", "docs/directing.md"}) {
    for (const std::string& block : fenced_blocks(kSource / file, "sh")) {
      std::istringstream lines(block);
      for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line.substr(0, line.find('#')));
        std::string program;
        words >> program;
        if (program.empty()) continue;
        std::vector<std::string> arguments;
        for (std::string word; words >> word;) arguments.push_back(word);
        ASSERT_FALSE(arguments.empty()) << line;
        const std::string command = arguments[0];
        if (program == "./bootstrap" && (command == "test" || command == "build" || command == "deps")) {
          EXPECT_THAT(read_text_file(kSource / "bootstrap"), HasSubstr("\n  " + command + ")\n"));
          continue;
        }
        ASSERT_TRUE(program == "./bootstrap" || program == "build/release/vivify") << line;
        const bool needs_results = command == "sheet" || command == "diff";
        const bool makes_frames =
            !needs_results && command != "check" && command != "schema" && command != "pose";
        if (makes_frames) arguments.emplace_back("--dry-run");
        const Outcome outcome = vivify(arguments, options);
        EXPECT_EQ(outcome.code, needs_results ? 5 : 0) << line << "\n" << outcome.err;
        ++tried;
      }
    }
  }
  EXPECT_GE(tried, 12);
}

TEST(Docs, SmallestSceneRuns) {
  const TemporaryFolder clone;
  make_clone(clone);
  ProgramOptions options;
  options.folder = clone.path();
  const Outcome outcome = vivify({"run", "configs/small.yaml", "--size", "64x36", "--spp", "1",
                                  "--progress=none", "--set", "frames.duration_s=0.125"},
                                 options);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "out/small/small.mp4\n");
  EXPECT_GT(fs::file_size(clone / "out/small/small.mp4"), 500u);
}

TEST(Docs, ScenesOfTheGuidesAreRight) {
  const TemporaryFolder clone;
  make_clone(clone);
  const std::vector<fs::path> scenes = write_guide_scenes(clone.path());
  EXPECT_GE(scenes.size(), 12);
  for (const fs::path& scene : scenes) {
    const Outcome outcome = vivify({"check", scene.string()});
    EXPECT_EQ(outcome.code, 0) << read_text_file(scene) << outcome.err;
    EXPECT_EQ(outcome.err, "") << read_text_file(scene);
  }
}

TEST(Docs, LinksLeadSomewhere) {
  const std::regex link(R"(\]\(([^)#]+)\))");
  for (const char* file :
       {"README.md", "CHANGELOG.md", "docs/user_guide.md", "docs/directing.md", "docs/reference.md"}) {
    const std::string text = read_text_file(kSource / file);
    for (std::sregex_iterator it(text.begin(), text.end(), link), end; it != end; ++it) {
      const std::string target = (*it)[1];
      if (target.starts_with("http")) continue;
      EXPECT_TRUE(fs::exists((kSource / file).parent_path() / target)) << file << ": " << target;
    }
  }
}

TEST(Docs, UserGuideNamesEveryOption) {
  const std::string guide = read_text_file(kSource / "docs/user_guide.md");
  const std::string help = vivify({"run", "--help"}).out;
  const std::regex option(R"(--[a-z][a-z-]*)");
  int seen = 0;
  for (std::sregex_iterator it(help.begin(), help.end(), option), end; it != end; ++it) {
    const std::string name = it->str();
    // Long forms of -o, -j, -v, -q and -h stand in --help only.
    if (name == "--output" || name == "--threads" || name == "--verbose" || name == "--quiet" ||
        name == "--help")
      continue;
    EXPECT_THAT(guide, HasSubstr(name));
    ++seen;
  }
  EXPECT_GE(seen, 8);
}

}  // namespace
}  // namespace vivify::pipeline
