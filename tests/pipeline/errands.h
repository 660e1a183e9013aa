// Characters of the cast that are sent elsewhere by command line alone.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/pipeline/cast_table.h"
#include "tests/pipeline/scene_run.h"

namespace vivify::testing_support {

// Runs the errands of a character whose names contain `which`, and returns how many these are.
inline int expect_errands_done(const std::string& scene, const std::string& body,
                               const std::string& which = "") {
  const TemporaryFolder folder;
  int count = 0;
  for (const Role& role : roles_in(scene)) {
    if (role.body != body) continue;
    for (const Errand& errand : errands(role)) {
      if (errand.name.find(which) == std::string::npos) continue;
      const SceneResult run = simulated(folder.path() / "out", scene + ".yaml", errand.options);
      EXPECT_THAT(shortcomings(run, errand.role), ::testing::IsEmpty()) << errand.name;
      ++count;
    }
  }
  return count;
}

}  // namespace vivify::testing_support
