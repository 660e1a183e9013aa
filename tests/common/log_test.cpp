#include "common/log.h"

#include <gtest/gtest.h>

namespace vivify {
namespace {

TEST(Log, DropsMessagesUntilSetUpThenShowsItsLevelAndAbove) {
  ::testing::internal::CaptureStderr();
  log_error("lost");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");

  ::testing::internal::CaptureStderr();
  log_to_stderr(LogLevel::info);
  log_debug("hidden");
  log_info("body {cup}: 5 %");
  log_warning("repaired");
  log_error("bad");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(),
            "vivify: body {cup}: 5 %\nvivify: warning: repaired\nvivify: error: bad\n");

  ::testing::internal::CaptureStderr();
  log_to_stderr(LogLevel::error);
  log_warning("hidden");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace vivify
