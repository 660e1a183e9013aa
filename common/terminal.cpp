#include "common/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>
#include <mutex>

namespace vivify::terminal {
namespace {

std::mutex mutex;
std::string status;

void write(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

constexpr const char* kClear = "\r\x1b[K";

}  // namespace

bool is_terminal() { return ::isatty(STDERR_FILENO) == 1; }

int width() {
  winsize size = {};
  return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 10 ? size.ws_col : 80;
}

void show_status(const std::string& line) {
  std::string cut;
  int columns = 0;
  for (const char c : line) {
    const bool begins = (static_cast<unsigned char>(c) & 0xC0) != 0x80;
    if (begins && ++columns >= width()) break;
    cut += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  const std::scoped_lock lock(mutex);
  status = cut;
  write(kClear + status);
}

void clear_status() {
  const std::scoped_lock lock(mutex);
  if (!status.empty()) write(kClear);
  status.clear();
}

void print(const std::string& lines) {
  const std::scoped_lock lock(mutex);
  if (status.empty()) {
    write(lines);
  } else {
    write(kClear + lines + status);
  }
}

}  // namespace vivify::terminal
