// Log messages of the libraries. They go to a sink that the command line sets up; without one they are dropped.
#pragma once

#include <string>

namespace vivify {

enum class LogLevel { debug, info, warning, error };

// One line to the log; thread-safe.
void log(LogLevel level, const std::string& message);
inline void log_debug(const std::string& message) { log(LogLevel::debug, message); }
inline void log_info(const std::string& message) { log(LogLevel::info, message); }
inline void log_warning(const std::string& message) { log(LogLevel::warning, message); }
inline void log_error(const std::string& message) { log(LogLevel::error, message); }

// Sends messages of `level` and above to standard error (spdlog). Called by the command line only.
void log_to_stderr(LogLevel level);

}  // namespace vivify
