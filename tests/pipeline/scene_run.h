// A scene of configs/ that was simulated, for tests of what happens in it.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/common/temporary_folder.h"
#include "tests/pipeline/program.h"
#include "tests/pipeline/scene_result.h"

namespace vivify::testing_support {

class SceneRun : private TemporaryFolder, public SceneResult {
 public:
  // `options`: of the command line, besides.
  explicit SceneRun(const std::string& scene, const std::vector<std::string>& options = {})
      : SceneResult(simulated(path() / "out", scene, options)) {}

 private:
  static std::filesystem::path simulated(const std::filesystem::path& out, const std::string& scene,
                                         const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {
        "simulate", VIVIFY_SOURCE_DIR "/configs/" + scene, "-o", out.string(), "--progress=none", "-q"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const Outcome outcome = vivify(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return out;
  }
};

}  // namespace vivify::testing_support
