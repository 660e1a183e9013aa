#include "common/error.h"

#include <gtest/gtest.h>

namespace vivify {
namespace {

TEST(Error, ExitCodesAreThoseOfTheContract) {
  EXPECT_EQ(exit_code(ErrorKind::usage), 2);
  EXPECT_EQ(exit_code(ErrorKind::geometry), 3);
  EXPECT_EQ(exit_code(ErrorKind::numerical), 4);
  EXPECT_EQ(exit_code(ErrorKind::io), 5);
  EXPECT_EQ(exit_code(ErrorKind::internal), 70);
  EXPECT_EQ(exit_code(ErrorKind::stopped), 75);
  EXPECT_EQ(exit_code(ErrorKind::interrupted), 130);
}

TEST(Error, TextNamesPlaceMessageAndHint) {
  const Error error(ErrorKind::usage, "unknown key 'a'", "did you mean b?", {"walk.yaml", 14, 21});
  EXPECT_EQ(error.full_text(), "walk.yaml:14:21: error: unknown key 'a' (did you mean b?)");
  EXPECT_EQ(Error(ErrorKind::io, "no").full_text(), "error: no");
  EXPECT_EQ(Error(ErrorKind::usage, "no", "", {"--set", 0, 0}).full_text(), "--set: error: no");
}

}  // namespace
}  // namespace vivify
