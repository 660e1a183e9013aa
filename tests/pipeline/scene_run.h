// A scene of configs/ that was simulated, for tests of what happens in it.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/common/temporary_folder.h"
#include "tests/pipeline/program.h"
#include "tests/pipeline/scene_result.h"

namespace vivify::testing_support {

// Into a folder, which keeps the meshes for the next run; `options`: of the command line, besides.
inline SceneResult simulated(const std::filesystem::path& out, const std::string& scene,
                             const std::vector<std::string>& options = {}) {
  std::vector<std::string> arguments = {
      "simulate", VIVIFY_SOURCE_DIR "/configs/" + scene, "-o", out.string(), "--progress=none", "-q"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const Outcome outcome = vivify(arguments);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  return SceneResult(out);
}

class SceneRun : private TemporaryFolder, public SceneResult {
 public:
  explicit SceneRun(const std::string& scene, const std::vector<std::string>& options = {})
      : SceneResult(simulated(path() / "out", scene, options)) {}
};

}  // namespace vivify::testing_support
