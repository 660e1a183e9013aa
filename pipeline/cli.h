// The command line: reads arguments, calls the commands, prints errors, gives the exit code.
#pragma once

namespace vivify::pipeline {

// Runs the program. Exit codes are those of docs/user_guide.md.
int run_command_line(int argc, char** argv);

}  // namespace vivify::pipeline
