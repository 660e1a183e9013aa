#include "common/stop.h"

#include <atomic>
#include <csignal>

#include "common/error.h"

namespace vivify {
namespace {

// Any thread may get the signal, and any thread asks for it.
std::atomic<int> asked_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free, "what a signal handler may use");

void on_signal(int signal) { asked_signal = signal; }

}  // namespace

void install_stop_handlers() {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  for (const int signal : {SIGTERM, SIGUSR1, SIGINT}) sigaction(signal, &action, nullptr);
  // A file that grows beyond RLIMIT_FSIZE is then an error of write() that can be reported.
  action.sa_handler = SIG_IGN;
  sigaction(SIGXFSZ, &action, nullptr);
}

void check_stop() {
  const int signal = asked_signal;
  if (signal == 0) return;
  if (signal == SIGINT)
    throw Error(ErrorKind::interrupted, "interrupted", "run the same command again to go on");
  throw Error(ErrorKind::stopped, "stopped on request", "run the same command again to go on");
}

}  // namespace vivify
