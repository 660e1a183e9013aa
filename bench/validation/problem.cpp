#include "bench/validation/problem.h"

#include <array>
#include <cmath>
#include <cstdio>

namespace vivify::validation {
namespace {

constexpr std::array kProblems = {
    ProblemEntry{"cantilever", cantilever},
    ProblemEntry{"large_deflection", large_deflection},
    ProblemEntry{"inversion", inversion},
};

}  // namespace

double Figure::error() const {
  return reference == 0 ? std::abs(ours) : std::abs(ours - reference) / std::abs(reference);
}

std::span<const ProblemEntry> problems() { return kProblems; }

std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

}  // namespace vivify::validation
