#include "pipeline/child_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include "common/error.h"

extern char** environ;

namespace vivify::pipeline {
namespace {

constexpr std::size_t kKeptOutput = 65536;

// Reads everything from `descriptor`, keeps the end of it, and closes it.
void listen_to(int descriptor, std::string& kept) {
  std::array<char, 4096> block;
  while (true) {
    const ssize_t n = ::read(descriptor, block.data(), block.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    kept.append(block.data(), static_cast<std::size_t>(n));
    if (kept.size() > kKeptOutput) kept.erase(0, kept.size() - kKeptOutput);
  }
  ::close(descriptor);
}

// Starts the program with the given standard input and output; returns an errno, 0 for success.
int spawn(const std::string& program, const std::vector<std::string>& arguments, int input, int output,
          pid_t& pid) {
  std::vector<char*> words{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&files);
  posix_spawnattr_init(&attributes);
  posix_spawn_file_actions_adddup2(&files, input, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&files, output, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, output, STDERR_FILENO);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);
  const int error = ::posix_spawn(&pid, program.c_str(), &files, &attributes, words.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  return error;
}

int wait_for(pid_t pid) {
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace

std::filesystem::path find_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (folder.empty()) continue;
    const std::filesystem::path file = std::filesystem::path(folder) / name;
    std::error_code error;
    if (std::filesystem::is_regular_file(file, error) && ::access(file.c_str(), X_OK) == 0) return file;
  }
  return {};
}

ChildProcess::ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments) {
  const auto fail = [&](int error) {
    throw Error(ErrorKind::io, "cannot start " + program.string() + ": " + std::strerror(error));
  };
  // A socket instead of a pipe: send() can be told not to raise SIGPIPE.
  std::array<int, 2> input;   // ours, the child's
  std::array<int, 2> output;  // ours, the child's
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, input.data()) != 0) fail(errno);
  if (::pipe2(output.data(), O_CLOEXEC) != 0) {
    const int error = errno;
    ::close(input[0]);
    ::close(input[1]);
    fail(error);
  }
  pid_t pid = -1;
  const int error = spawn(program.string(), arguments, input[1], output[1], pid);
  ::close(input[1]);
  ::close(output[1]);
  if (error != 0) {
    ::close(input[0]);
    ::close(output[0]);
    fail(error);
  }
  pid_ = pid;
  input_ = input[0];
  listener_ = std::thread(listen_to, output[0], std::ref(output_));
}

ChildProcess::~ChildProcess() {
  if (pid_ < 0) return;
  ::kill(pid_, SIGKILL);
  finish();
}

bool ChildProcess::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::send(input_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
  return true;
}

ChildProcess::Outcome ChildProcess::finish() {
  ::close(input_);
  const int status = wait_for(pid_);
  listener_.join();
  pid_ = -1;
  Outcome outcome;
  outcome.output = std::move(output_);
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    outcome.ending = "was killed by signal " + std::to_string(signal) + " (" + ::strsignal(signal) + ")";
  } else {
    outcome.success = WEXITSTATUS(status) == 0;
    outcome.ending = "ended with code " + std::to_string(WEXITSTATUS(status));
  }
  return outcome;
}

}  // namespace vivify::pipeline
