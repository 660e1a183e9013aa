#include "common/progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "common/log.h"

namespace vivify {
namespace {

using ::testing::HasSubstr;

TEST(RemainingSeconds, IsExactForUniformWork) {
  EXPECT_DOUBLE_EQ(remaining_seconds(10, 100, 10, 0), 90);
  EXPECT_DOUBLE_EQ(remaining_seconds(10, 100, 60, 50), 40);  // resumed units were not done at this pace
  EXPECT_TRUE(std::isinf(remaining_seconds(10, 100, 50, 50)));
  EXPECT_TRUE(std::isinf(remaining_seconds(0, 100, 0, 0)));
  EXPECT_EQ(remaining_seconds(10, 100, 100, 0), 0);
  EXPECT_EQ(remaining_seconds(0, 0, 0, 0), 0);
}

std::vector<nlohmann::json> json_lines(const std::string& text) {
  std::vector<nlohmann::json> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(nlohmann::json::parse(line));
  return lines;
}

TEST(JsonProgress, PrintsOneObjectPerEvent) {
  ::testing::internal::CaptureStdout();
  const std::unique_ptr<Progress> progress = make_progress(ProgressStyle::json);
  progress->start("simulate", 96, 10);
  progress->advance(2, "body \"cup\"\n\xff");
  progress->advance(84);
  progress->finish();
  const auto lines = json_lines(::testing::internal::GetCapturedStdout());
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(lines[0]["event"], "start");
  EXPECT_EQ(lines[0]["stage"], "simulate");
  EXPECT_EQ(lines[0]["done"], 10);
  EXPECT_EQ(lines[0]["total"], 96);
  EXPECT_TRUE(lines[0]["remaining_s"].is_null());
  EXPECT_EQ(lines[1]["event"], "advance");
  EXPECT_EQ(lines[1]["done"], 12);
  EXPECT_THAT(lines[1]["note"].get<std::string>(), HasSubstr("body \"cup\""));
  EXPECT_EQ(lines[2]["done"], 96);
  EXPECT_EQ(lines[2]["remaining_s"], 0);
  EXPECT_EQ(lines[3]["event"], "finish");
}

TEST(JsonProgress, RemainingTimeFollowsThePaceAfterATenth) {
  ::testing::internal::CaptureStdout();
  const std::unique_ptr<Progress> progress = make_progress(ProgressStyle::json);
  progress->start("render", 60, 40);  // 20 units of work are left
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  progress->advance(2);
  progress->finish();
  const auto lines = json_lines(::testing::internal::GetCapturedStdout());
  const double elapsed = lines[1]["elapsed_s"], remaining = lines[1]["remaining_s"];
  EXPECT_GE(elapsed, 0.03);
  EXPECT_NEAR(remaining, elapsed * 9, elapsed * 0.01);
}

TEST(PlainProgress, PrintsALineEveryTenth) {
  ::testing::internal::CaptureStderr();
  const std::unique_ptr<Progress> progress = make_progress(ProgressStyle::plain);
  progress->start("render", 200);
  for (int i = 0; i < 200; ++i) progress->advance(1, "note");
  progress->finish();
  const std::string text = ::testing::internal::GetCapturedStderr();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 10);
  EXPECT_THAT(text, ::testing::StartsWith("render: 20/200, "));
  EXPECT_THAT(text, HasSubstr("\nrender: 200/200 in "));
  EXPECT_EQ(text.find('\x1b'), std::string::npos);
}

TEST(BarProgress, RedrawsSeldomAndLeavesWholeLines) {
  ::testing::internal::CaptureStderr();
  {
    const std::unique_ptr<Progress> progress = make_progress(ProgressStyle::bar);
    progress->start("render", 100000);
    for (int i = 0; i < 100000; ++i) progress->advance(1, "a rather long note é " + std::string(200, 'x'));
    log_to_stderr(LogLevel::info);
    log_info("in between");
    progress->finish();
    progress->start("encode", 10);
    progress->advance(1);
  }  // given up: as when an error is thrown
  const std::string text = ::testing::internal::GetCapturedStderr();
  EXPECT_LT(std::count(text.begin(), text.end(), '\r'), 60);  // 100 000 calls take well below 10 s
  EXPECT_THAT(text, HasSubstr("\r\x1b[Kvivify: in between\n"));
  EXPECT_THAT(text, HasSubstr("\r\x1b[Krender: 100000/100000 in "));
  EXPECT_TRUE(text.ends_with("\r\x1b[K")) << "the cursor must stand on an empty line";
  std::istringstream lines(text);
  for (std::string part; std::getline(lines, part, '\r');) EXPECT_LT(part.size(), 3 + 2 * 160U);
}

TEST(NoProgress, SaysNothing) {
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  const std::unique_ptr<Progress> progress = make_progress(ProgressStyle::none);
  progress->start("mesh", 3);
  progress->advance(3);
  progress->finish();
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace vivify
