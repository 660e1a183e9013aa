#include "pipeline/child_process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>

#include "common/error.h"

namespace vivify::pipeline {
namespace {

using testing::HasSubstr;

std::span<const std::byte> bytes(const std::string& text) { return std::as_bytes(std::span(text)); }

TEST(ChildProcess, GetsItsInputAndIsHeard) {
  ChildProcess child("/bin/sh", {"-c", "wc -c; echo done >&2"});
  const std::string block(1 << 20, 'x');
  EXPECT_TRUE(child.write(bytes(block)));
  EXPECT_TRUE(child.write(bytes(block)));
  const ChildProcess::Outcome outcome = child.finish();
  EXPECT_TRUE(outcome.success);
  EXPECT_THAT(outcome.output, HasSubstr("2097152\ndone\n"));
}

TEST(ChildProcess, TellsHowTheChildEnded) {
  ChildProcess failing("/bin/sh", {"-c", "echo no paper >&2; exit 3"});
  const ChildProcess::Outcome failed = failing.finish();
  EXPECT_FALSE(failed.success);
  EXPECT_EQ(failed.ending, "ended with code 3");
  EXPECT_EQ(failed.output, "no paper\n");
  ChildProcess killed("/bin/sh", {"-c", "kill -KILL $$"});
  EXPECT_EQ(killed.finish().ending, "was killed by signal 9 (Killed)");
}

TEST(ChildProcess, WritingToADeadChildRaisesNoSignal) {
  ChildProcess child("/bin/sh", {"-c", "exit 0"});
  const std::string block(1 << 20, 'x');
  bool taken = true;
  for (int i = 0; i < 100 && taken; ++i) taken = child.write(bytes(block));
  EXPECT_FALSE(taken);
}

TEST(ChildProcess, AFloodOfOutputNeitherBlocksNorFillsTheMemory) {
  ChildProcess child("/bin/sh",
                     {"-c", "head -c 3000000 /dev/zero | tr '\\0' 'a'; echo; cat > /dev/null; echo end"});
  EXPECT_TRUE(child.write(bytes(std::string(1 << 20, 'x'))));
  const ChildProcess::Outcome outcome = child.finish();
  EXPECT_EQ(outcome.output.size(), 65536u);
  EXPECT_TRUE(outcome.output.ends_with("a\nend\n"));
}

TEST(ChildProcess, AnAbandonedChildIsKilled) {
  const auto begin = std::chrono::steady_clock::now();
  { ChildProcess child("/bin/sh", {"-c", "exec sleep 60"}); }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
}

TEST(ChildProcess, AMissingProgramIsAnError) {
  EXPECT_THROW(ChildProcess("/no/such/program", {}), Error);
  EXPECT_TRUE(find_program("no_such_program_anywhere").empty());
  EXPECT_EQ(find_program("sh").filename(), "sh");
}

}  // namespace
}  // namespace vivify::pipeline
