// The scenes of the guides as people type them in.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/common/temporary_folder.h"
#include "tests/pipeline/guides.h"
#include "tests/pipeline/program.h"

namespace vivify::pipeline {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

TEST(Docs, ScenesOfTheGuidesPlayToTheirEnd) {
  const testing_support::TemporaryFolder clone;
  fs::create_directory_symlink(fs::path(VIVIFY_SOURCE_DIR) / "assets", clone / "assets");
  fs::create_directory(clone / "configs");
  for (const fs::path& scene : testing_support::write_guide_scenes(clone.path())) {
    const testing_support::Outcome outcome = testing_support::vivify(
        {"simulate", scene.string(), "-o", (clone / scene.stem().string()).string(), "--progress=none"});
    EXPECT_EQ(outcome.code, 0) << read_text_file(scene) << outcome.err;
    EXPECT_THAT(outcome.err, Not(HasSubstr("did not arrive"))) << read_text_file(scene);
  }
}

}  // namespace
}  // namespace vivify::pipeline
