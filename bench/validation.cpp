// Runs every validation problem with its long sweeps and writes docs/validation.md with its plots; with names
// as arguments, prints the figures of those problems instead.
#include <algorithm>
#include <cstdio>
#include <cstring>

#include "bench/validation/report.h"
#include "common/error.h"
#include "common/registry.h"

namespace vivify::validation {
namespace {

int missed(const Result& result) {
  int count = 0;
  std::printf("%s\n", result.title.c_str());
  for (const Figure& figure : result.figures) {
    std::printf("  %-70s %-14.8g %-14.8g error %-8.2g of %-8.2g%s\n", figure.name.c_str(), figure.ours,
                figure.reference, figure.error(), figure.tolerance, figure.holds() ? "" : " MISSED");
    count += !figure.holds();
  }
  std::fflush(stdout);
  return count;
}

int run(int argc, char** argv) {
  int count = 0;
  Effort effort = Effort::full;
  std::vector<std::string> names;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--quick") == 0) {
      effort = Effort::quick;
    } else {
      names.emplace_back(argv[i]);
    }
  }
  std::vector<Result> results;
  for (const ProblemEntry& entry : problems()) {
    if (!names.empty() && std::find(names.begin(), names.end(), entry.name) == names.end()) continue;
    results.push_back(entry.run(effort));
    count += missed(results.back());
  }
  if (names.empty() && effort == Effort::full) write_report(results, VIVIFY_SOURCE_DIR "/docs/validation.md");
  return count == 0 ? 0 : 1;
}

}  // namespace
}  // namespace vivify::validation

int main(int argc, char** argv) {
  try {
    return vivify::validation::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
