// Runs the real executable, as a person would.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace vivify::testing_support {

struct Outcome {
  int code = -1;  // exit code; 128 + the signal when it was killed
  std::string out, err;
};

struct ProgramOptions {
  std::filesystem::path folder;  // working folder; empty: the present one
  std::map<std::string, std::string> environment;
  std::optional<long> largest_file;      // RLIMIT_FSIZE, bytes
  std::function<bool()> interrupt_when;  // asked often; when true, `signal` is sent once
  int signal = 0;
};

Outcome run_program(const std::vector<std::string>& command, const ProgramOptions& options = {});

// The vivify of this build, with --progress=none for the commands that show progress left to the caller.
Outcome vivify(std::vector<std::string> arguments, const ProgramOptions& options = {});

// Every regular file below `folder`, by relative path, with its content; nothing when there is no such
// folder.
std::map<std::string, std::string> files_below(const std::filesystem::path& folder);

}  // namespace vivify::testing_support
