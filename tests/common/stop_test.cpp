#include "common/stop.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <thread>
#include <vector>

#include "common/error.h"

namespace vivify {
namespace {

// The exit code that a process makes of the signal.
int exit_code_after(int signal) {
  const pid_t child = ::fork();
  if (child == 0) {
    install_stop_handlers();
    try {
      check_stop();
      ::raise(signal);
      check_stop();
    } catch (const Error& error) {
      ::_exit(exit_code(error.kind()));
    }
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(Stop, SignalsBecomeExitCodes) {
  EXPECT_EQ(exit_code_after(SIGTERM), 75);
  EXPECT_EQ(exit_code_after(SIGUSR1), 75);
  EXPECT_EQ(exit_code_after(SIGINT), 130);
  EXPECT_EQ(exit_code_after(SIGXFSZ), 0);
}

// The exit code that two threads at work make of a signal that a third one gets.
[[noreturn]] void exit_when_all_stop() {
  install_stop_handlers();
  std::array<bool, 2> stopped = {};
  {
    std::vector<std::jthread> threads;
    for (bool& mine : stopped) {
      threads.emplace_back([&mine] {
        try {
          for (;;) check_stop();
        } catch (const Error& error) {
          mine = error.kind() == ErrorKind::stopped;
        }
      });
    }
    threads.emplace_back([] { ::raise(SIGTERM); });
  }
  std::exit(stopped[0] && stopped[1] ? 75 : 1);
}

TEST(Stop, EveryThreadSeesASignalThatOneGets) {
  ::testing::FLAGS_gtest_death_test_style = "threadsafe";  // a process of its own, not a fork of many threads
  EXPECT_EXIT(exit_when_all_stop(), ::testing::ExitedWithCode(75), "");
}

}  // namespace
}  // namespace vivify
