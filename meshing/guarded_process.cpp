#include "meshing/guarded_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <ctime>
#include <new>

#include "common/error.h"
#include "common/stop.h"
#include "common/text.h"
#include "meshing/byte_stream.h"

namespace vivify::meshing {
namespace {

constexpr int kPollMilliseconds = 100;
constexpr double kWallFactor =
    10;  // wall time, in limits of processor time, after which a sleeping child ends

// Processor time that a child has used so far; 0 when it is gone.
double processor_seconds(pid_t child) {
  clockid_t clock = {};
  timespec time = {};
  if (clock_getcpuclockid(child, &clock) != 0 || clock_gettime(clock, &time) != 0) return 0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// The first byte of the answer of a guarded child.
enum class Answer : std::uint8_t { result, our_error, other_error };

// A child that is killed and reaped, and a socket that is closed, when they go out of scope.
class Child {
 public:
  Child(pid_t id, int socket) : id_(id), socket_(socket) {}
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    close(socket_);
    if (id_ > 0) {
      kill(id_, SIGKILL);
      wait();
    }
  }
  void end() { kill(id_, SIGKILL); }
  int wait() {
    int status = 0;
    while (waitpid(id_, &status, 0) < 0 && errno == EINTR) {
    }
    id_ = 0;
    return status;
  }

 private:
  pid_t id_;
  int socket_;
};

[[noreturn]] void system_error(const std::string& what) {
  throw Error(ErrorKind::io, what + ": " + std::strerror(errno));
}

bool send_all(int socket, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(sent));
  }
  return true;
}

[[noreturn]] void run_in_child(int socket, const ProcessLimits& limits, const std::function<Bytes()>& work) {
  become_quiet_child();
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) std::signal(signal, SIG_IGN);  // the parent decides
  limit_own_memory(limits.megabytes);
  ByteWriter answer;
  bool sent = false;
  try {
    try {
      const Bytes result = work();
      const std::byte kind{static_cast<std::uint8_t>(Answer::result)};
      sent = send_all(socket, {&kind, 1}) && send_all(socket, result);
      _exit(sent ? 0 : 1);
    } catch (const Error& error) {
      answer.put(static_cast<std::uint8_t>(Answer::our_error)).put(static_cast<int>(error.kind()));
      answer.put(std::string(error.what())).put(error.hint());
    } catch (const std::bad_alloc&) {
      _exit(kOutOfMemoryExit);
    } catch (const std::exception& error) {
      answer.put(static_cast<std::uint8_t>(Answer::other_error)).put(std::string(error.what()));
    }
    sent = send_all(socket, answer.take());
  } catch (...) {
    _exit(kOutOfMemoryExit);
  }
  _exit(sent ? 0 : 1);
}

}  // namespace

bool ChildOutcome::succeeded() const { return !timed_out && exit_code() == 0; }

int ChildOutcome::exit_code() const { return WIFEXITED(wait_status) ? WEXITSTATUS(wait_status) : -1; }

std::string ChildOutcome::describe(const ProcessLimits& limits) const {
  if (timed_out) return "did not end within " + number_text(limits.seconds) + " s";
  if (exit_code() == kOutOfMemoryExit)
    return "needs more than " + number_text(limits.megabytes) + " MB of memory";
  if (WIFSIGNALED(wait_status)) return std::string("crashed (") + strsignal(WTERMSIG(wait_status)) + ")";
  return "ended with code " + std::to_string(exit_code());
}

ChildOutcome converse(pid_t child_id, int socket, std::span<const std::byte> request,
                      const ProcessLimits& limits) {
  using Clock = std::chrono::steady_clock;
  Child child(child_id, socket);
  ChildOutcome outcome;
  const auto deadline =
      Clock::now() + std::chrono::duration<double>(kWallFactor * std::min(limits.seconds, 1e7));
  fcntl(socket, F_SETFL, fcntl(socket, F_GETFL) | O_NONBLOCK);
  if (request.empty()) shutdown(socket, SHUT_WR);
  std::vector<std::byte> buffer(1 << 16);
  for (;;) {
    check_stop();
    if (processor_seconds(child_id) >= limits.seconds || Clock::now() >= deadline) {
      child.end();
      outcome.timed_out = true;
      break;
    }
    pollfd event = {socket, static_cast<short>(POLLIN | (request.empty() ? 0 : POLLOUT)), 0};
    if (poll(&event, 1, kPollMilliseconds) <= 0) continue;
    if ((event.revents & POLLOUT) != 0 && !request.empty()) {
      const ssize_t sent = send(socket, request.data(), request.size(), MSG_NOSIGNAL);
      if (sent > 0) request = request.subspan(static_cast<std::size_t>(sent));
      if (sent < 0 && errno != EINTR && errno != EAGAIN) request = {};  // the child is gone: its status tells
      if (request.empty()) shutdown(socket, SHUT_WR);
    }
    if ((event.revents & (POLLIN | POLLHUP | POLLERR)) != 0) {
      const ssize_t received = recv(socket, buffer.data(), buffer.size(), 0);
      if (received > 0)
        outcome.answer.insert(outcome.answer.end(), buffer.begin(), buffer.begin() + received);
      if (received == 0 || (received < 0 && errno != EINTR && errno != EAGAIN)) break;
    }
  }
  outcome.wait_status = child.wait();
  check_stop();
  return outcome;
}

Bytes run_guarded(const std::string& what, const std::string& hint, const ProcessLimits& limits,
                  const std::function<Bytes()>& work) {
  std::array<int, 2> sockets = {};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets.data()) != 0) {
    system_error("cannot make a socket pair");
  }
  const pid_t child = fork();
  if (child < 0) system_error("cannot start a child process");
  if (child == 0) {
    close(sockets[0]);
    run_in_child(sockets[1], limits, work);
  }
  close(sockets[1]);
  ChildOutcome outcome = converse(child, sockets[0], {}, limits);
  if (!outcome.succeeded() || outcome.answer.empty()) {
    throw Error(ErrorKind::geometry, what + " " + outcome.describe(limits), hint);
  }
  const auto kind = static_cast<Answer>(outcome.answer.front());
  outcome.answer.erase(outcome.answer.begin());
  if (kind == Answer::result) return std::move(outcome.answer);
  ByteReader reader(outcome.answer);
  std::string message, own_hint;
  if (kind == Answer::our_error) {
    int error_kind = 0;
    reader.get(error_kind);
    reader.get(message);
    reader.get(own_hint);
    throw Error(static_cast<ErrorKind>(error_kind), message, own_hint);
  }
  reader.get(message);
  throw Error(ErrorKind::geometry, what + " failed: " + message, hint);
}

}  // namespace vivify::meshing
