// The one error type of vivify. Libraries throw it; only the command line prints it and turns it into an exit code.
#pragma once

#include <stdexcept>
#include <string>

namespace vivify {

enum class ErrorKind {
  usage,        // wrong command line or scene file
  geometry,     // bad geometry or asset
  numerical,    // a solver could not go on
  io,           // reading or writing failed
  internal,     // a defect of ours
  stopped,      // stopped early on request (SIGTERM, SIGUSR1, time limit): run again to go on
  interrupted,  // Ctrl-C
};

// Exit code of the program for an error of this kind (docs/user_guide.md, "Exit codes").
int exit_code(ErrorKind kind);

// A place in a text file. Lines and columns count from 1; 0 means unknown.
struct Location {
  std::string file;
  int line = 0;
  int column = 0;

  // "file:line:col", without the parts that are unknown; empty when nothing is known.
  std::string text() const;
};

class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message, std::string hint = {}, Location where = {});

  ErrorKind kind() const { return kind_; }
  const Location& where() const { return where_; }
  const std::string& hint() const { return hint_; }

  // "file:line:col: error: message (hint)": the line that is shown to the user.
  std::string full_text() const;

 private:
  ErrorKind kind_;
  std::string hint_;
  Location where_;
};

}  // namespace vivify
