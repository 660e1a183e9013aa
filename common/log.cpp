#include "common/log.h"

#include <spdlog/logger.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/base_sink.h>

#include <atomic>
#include <memory>
#include <mutex>

#include "common/terminal.h"

namespace vivify {
namespace {

class StderrSink final : public spdlog::sinks::base_sink<std::mutex> {
 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    spdlog::memory_buf_t text;
    formatter_->format(message, text);
    terminal::print(std::string(text.data(), text.size()));
  }
  void flush_() override {}
};

spdlog::level::level_enum spdlog_level(LogLevel level) {
  switch (level) {
    case LogLevel::debug:
      return spdlog::level::debug;
    case LogLevel::info:
      return spdlog::level::info;
    case LogLevel::warning:
      return spdlog::level::warn;
    case LogLevel::error:
      return spdlog::level::err;
  }
  return spdlog::level::err;
}

// Lives until the process ends, so that late messages find it.
std::atomic<spdlog::logger*> logger = nullptr;

}  // namespace

void log(LogLevel level, const std::string& message) {
  spdlog::logger* const current = logger.load();
  if (current == nullptr) return;
  // Ordinary news carries no level.
  const char* const prefix = level == LogLevel::warning ? "warning: "
                             : level == LogLevel::error ? "error: "
                             : level == LogLevel::debug ? "debug: "
                                                        : "";
  current->log(spdlog_level(level), "{}{}", prefix, message);
}

void log_to_stderr(LogLevel level) {
  static spdlog::logger instance("vivify", std::make_shared<StderrSink>());
  static std::once_flag once;
  std::call_once(once, [] { instance.set_pattern("%n: %v"); });
  instance.set_level(spdlog_level(level));
  logger.store(&instance);
}

}  // namespace vivify
