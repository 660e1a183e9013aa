// The scene of the repository, configs/teacup.yaml, compared with its golden images (docs/image_tests.md).
#include <gtest/gtest.h>

#include "common/file.h"
#include "tests/common/temporary_folder.h"
#include "tests/pipeline/program.h"
#include "tests/render/golden.h"

namespace vivify::pipeline {
namespace {

namespace fs = std::filesystem;
using testing_support::Outcome;
using testing_support::vivify;

// Renders frames of the first half second, as small as goldens are.
Outcome render_teacup(const fs::path& out, const std::vector<std::string>& options) {
  std::vector<std::string> arguments{"render",
                                     "configs/teacup.yaml",
                                     "-o",
                                     out.string(),
                                     "--size",
                                     "64x36",
                                     "--spp",
                                     "4",
                                     "--set",
                                     "frames.duration_s=0.5",
                                     "--progress=none"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  testing_support::ProgramOptions where;
  where.folder = VIVIFY_SOURCE_DIR;
  return vivify(arguments, where);
}

// One test, since its parts share the run of mesh, weights and simulation.
TEST(Golden, Teacup) {
  const testing_support::TemporaryFolder folder;
  const fs::path first = folder / "out/render/teacup.0001.exr",
                 moving = folder / "out/render/teacup.0012.exr";
  const Outcome outcome = render_teacup(folder / "out", {"--frames", "1,12"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  test::expect_golden("teacup.0001", read_file(first));
  // Contacts amplify rounding: on another processor the moving cup may be elsewhere by more than the
  // tolerance.
  if (test::on_reference_processor()) test::expect_golden("teacup.0012", read_file(moving));

  // The comparison sees one percent more colour on the cup.
  const fs::path right = folder / "right.exr";
  fs::copy_file(first, right);
  const Outcome wrong = render_teacup(
      folder / "out", {"--frames", "1", "--set", "materials.glaze.color=[0.1111, 0.3838, 0.4141]"});
  ASSERT_EQ(wrong.code, 0) << wrong.err;
  const Outcome diff = vivify({"diff", right.string(), first.string()});
  EXPECT_EQ(diff.code, 1) << diff.out << diff.err;
}

}  // namespace
}  // namespace vivify::pipeline
