// Limits of a child process.
#pragma once

namespace vivify::meshing {

struct ProcessLimits {
  double seconds = 60;      // processor time: the same work is allowed on a busy machine
  double megabytes = 4096;  // address space beyond what the child has at its start
};

// Exit code of a child that could not get memory.
inline constexpr int kOutOfMemoryExit = 101;

// Prepares the calling child process: it dies with its parent, leaves no core file, and prints nothing.
void become_quiet_child();

// Limits the memory of the calling process. Nothing is limited under a sanitizer.
void limit_own_memory(double megabytes);

}  // namespace vivify::meshing
