#include "pipeline/peak_memory.h"

#include <fstream>
#include <sstream>
#include <string>

namespace vivify::pipeline {

void reset_peak_memory() {
  std::ofstream file("/proc/self/clear_refs");
  file << "5\n";  // 5: reset the peak resident set size (man 5 proc)
}

double peak_memory_mb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (!line.starts_with("VmHWM:")) continue;
    double kilobytes = 0;
    std::istringstream(line.substr(6)) >> kilobytes;
    return kilobytes * 1024 / 1e6;
  }
  return 0;
}

}  // namespace vivify::pipeline
