#include "common/error.h"

namespace vivify {

int exit_code(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::usage:
      return 2;
    case ErrorKind::geometry:
      return 3;
    case ErrorKind::numerical:
      return 4;
    case ErrorKind::io:
      return 5;
    case ErrorKind::internal:
      return 70;
    case ErrorKind::stopped:
      return 75;
    case ErrorKind::interrupted:
      return 130;
  }
  return 70;
}

std::string Location::text() const {
  std::string text = file;
  if (line > 0) text += (text.empty() ? "" : ":") + std::to_string(line);
  if (line > 0 && column > 0) text += ":" + std::to_string(column);
  return text;
}

Error::Error(ErrorKind kind, const std::string& message, std::string hint, Location where)
    : std::runtime_error(message), kind_(kind), hint_(std::move(hint)), where_(std::move(where)) {}

std::string Error::full_text() const {
  std::string text = where_.text();
  if (!text.empty()) text += ": ";
  text += "error: ";
  text += what();
  if (!hint_.empty()) text += " (" + hint_ + ")";
  return text;
}

}  // namespace vivify
