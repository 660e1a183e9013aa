#include "common/memory.h"
#include "pipeline/cli.h"

int main(int argc, char** argv) {
  vivify::keep_freed_memory();
  return vivify::pipeline::run_command_line(argc, argv);
}
