#include "pipeline/cli.h"

int main(int argc, char** argv) { return vivify::pipeline::run_command_line(argc, argv); }
