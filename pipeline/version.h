// What this program was built from and runs on.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace vivify::pipeline {

// "0.1.0".
std::string program_version();

// Hash of the sources of `module` ("meshing", "sim" or "render") and of everything below it, and of how they
// were compiled. Throws Error(internal) for another name.
std::string source_revision(const std::string& module);

// Libraries and compiler with their versions, as found when the program was configured.
std::vector<std::pair<std::string, std::string>> library_versions();

// Model name of the processor.
std::string processor_name();

// Throws Error(usage) when the processor cannot run this program (x86-64-v3: AVX2, BMI2, FMA).
void check_processor();

}  // namespace vivify::pipeline
