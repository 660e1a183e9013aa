// The last line of standard error, shared by log messages and the progress bar so that neither breaks the
// other.
#pragma once

#include <string>

namespace vivify::terminal {

// Whether standard error is a terminal, and its width in characters.
bool is_terminal();
int width();

// Draws `line` as the last line, to be redrawn in place; cut to the width of the terminal.
void show_status(const std::string& line);
// Takes the status line away.
void clear_status();
// Prints whole lines; a status line moves below them.
void print(const std::string& lines);

}  // namespace vivify::terminal
