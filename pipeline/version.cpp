#include "pipeline/version.h"

#include <fstream>

#include "common/error.h"
#include "pipeline/build_info.h"

namespace vivify::pipeline {

std::string program_version() { return kProgramVersion; }

std::string source_revision(const std::string& module) {
  for (const auto& [name, revision] : kSourceRevisions) {
    if (module == name) return revision;
  }
  throw Error(ErrorKind::internal, "no module is called '" + module + "'");
}

std::vector<std::pair<std::string, std::string>> library_versions() {
  std::vector<std::pair<std::string, std::string>> versions;
  for (const auto& [name, version] : kLibraryVersions) versions.emplace_back(name, version);
  return versions;
}

std::string processor_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (!line.starts_with("model name")) continue;
    const std::size_t colon = line.find(": ");
    if (colon != line.npos) return line.substr(colon + 2);
  }
  return "unknown";
}

void check_processor() {
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("bmi2") || !__builtin_cpu_supports("fma")) {
    throw Error(ErrorKind::usage, "this processor lacks AVX2, BMI2 or FMA, which vivify needs",
                "run it on an x86-64 processor of 2013 or later (Haswell, Excavator)");
  }
}

}  // namespace vivify::pipeline
