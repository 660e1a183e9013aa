// Work that may crash, hang or eat all memory, run in a child process with limits.
#pragma once

#include <sys/types.h>

#include <functional>
#include <span>
#include <string>

#include "common/file.h"
#include "meshing/process_limits.h"

namespace vivify::meshing {

// What became of a child: its answer, and how it ended.
struct ChildOutcome {
  Bytes answer;
  bool timed_out = false;
  int wait_status = 0;  // of waitpid

  bool succeeded() const;  // ended by itself with exit code 0
  int exit_code() const;   // −1 when it was killed by a signal
  // "crashed (Segmentation fault)", "did not end within 60 s", "ran out of memory", "ended with code 3".
  std::string describe(const ProcessLimits& limits) const;
};

// Sends `request` to the child over the socket, closes that direction, collects everything the child sends
// back, and waits for its end; kills it when `limits.seconds` are over or a stop was asked for (then throws,
// see common/stop.h). Takes over `socket`.
ChildOutcome converse(pid_t child, int socket, std::span<const std::byte> request,
                      const ProcessLimits& limits);

// Runs `work` in a forked child and gives back what it returned. The child must not start threads. An Error
// thrown by `work` is thrown here again; any other exception, a crash, a time-out or a lack of memory becomes
// an Error(geometry) that reads "<what> <what happened>" with `hint`.
Bytes run_guarded(const std::string& what, const std::string& hint, const ProcessLimits& limits,
                  const std::function<Bytes()>& work);

}  // namespace vivify::meshing
