// A program that runs beside us: fed through its standard input, listened to through its output.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace vivify::pipeline {

// The executable file called `name` on the PATH; empty when there is none.
std::filesystem::path find_program(const std::string& name);

// A running child. It is in a process group of its own, so that Ctrl-C reaches only us; we end it.
class ChildProcess {
 public:
  // Starts `program`. Throws Error(io) when it cannot be started.
  ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments);
  ~ChildProcess();  // kills a child that was not waited for
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // Hands `bytes` to the child's standard input, waiting for it to take them; false once it takes no more (it
  // has ended or closed its input). Never raises SIGPIPE.
  bool write(std::span<const std::byte> bytes);

  struct Outcome {
    bool success = false;  // exit code 0
    std::string ending;    // "ended with code 1", "was killed by signal 9 (Killed)"
    std::string output;    // standard output and error together, as they came; the last 64 KB
  };
  // Closes the child's input and waits for its end.
  Outcome finish();

 private:
  int pid_ = -1;
  int input_ = -1;
  std::string output_;
  std::thread listener_;
};

}  // namespace vivify::pipeline
