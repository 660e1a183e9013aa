#include "pipeline/frame_range.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.h"

namespace vivify::pipeline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(FrameRange, ReadsNumbersRangesAndSteps) {
  EXPECT_THAT(parse_frames("7", 10), ElementsAre(7));
  EXPECT_THAT(parse_frames("1-4", 10), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(parse_frames("1-10x3", 10), ElementsAre(1, 4, 7, 10));
  EXPECT_THAT(parse_frames("1-6x2,4", 10), ElementsAre(1, 3, 4, 5));
  EXPECT_THAT(parse_frames("5-5", 5), ElementsAre(5));
}

TEST(FrameRange, SortsAndJoins) { EXPECT_THAT(parse_frames("9,1-3,2", 10), ElementsAre(1, 2, 3, 9)); }

TEST(FrameRange, RefusesEverythingElse) {
  for (const char* text : {"", "5-1", "0", "0-3", "11", "1-11", "a", "1-", "-3", "1,", ",1", "1-3x", "1-3x0",
                           "1x2", "1 - 3", "1-3x-1", "99999999999", "1.5", "+1"}) {
    EXPECT_THROW(parse_frames(text, 10), Error) << text;
  }
}

TEST(FrameRange, SaysWhatIsWrong) {
  const auto message = [](const char* text) -> std::string {
    try {
      parse_frames(text, 10);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(message("5-1"), HasSubstr("5-1 runs backwards"));
  EXPECT_THAT(message("3-12"), HasSubstr("there is no frame 12, the scene has frames 1-10"));
  EXPECT_THAT(message("0-2"), HasSubstr("count from 1"));
}

TEST(FrameRange, WritesFourDigits) {
  EXPECT_EQ(frame_text(7), "0007");
  EXPECT_EQ(frame_text(12345), "12345");
}

TEST(FramesText, IsReadBackAsTheSameFrames) {
  EXPECT_EQ(frames_text({}), "");
  EXPECT_EQ(frames_text({7}), "7");
  EXPECT_EQ(frames_text({1, 2, 3, 5, 7, 8}), "1-3,5,7-8");
  for (const char* text : {"1-100", "1-9x2,30-31", "5"}) {
    const std::vector<int> frames = parse_frames(text, 100);
    EXPECT_EQ(parse_frames(frames_text(frames), 100), frames) << text;
  }
}

}  // namespace
}  // namespace vivify::pipeline
