#include "bench/validation/problem.h"

#include <array>
#include <cmath>
#include <cstdio>

namespace vivify::validation {
namespace {

constexpr std::array kProblems = {
    ProblemEntry{"derivatives", derivatives},
    ProblemEntry{"elimination", elimination},
    ProblemEntry{"patch", patch},
    ProblemEntry{"rest_invariance", rest_invariance},
    ProblemEntry{"flight", flight},
    ProblemEntry{"integrator", integrator},
    ProblemEntry{"cantilever", cantilever},
    ProblemEntry{"large_deflection", large_deflection},
    ProblemEntry{"buckling", buckling},
    ProblemEntry{"inversion", inversion},
    ProblemEntry{"interpolation", interpolation},
    ProblemEntry{"slope", slope},
    ProblemEntry{"stopping", stopping},
    ProblemEntry{"resting", resting},
    ProblemEntry{"impact", impact},
    ProblemEntry{"corner_cases", corner_cases},
    ProblemEntry{"arch", arch},
    ProblemEntry{"card_house", card_house},
};

}  // namespace

double Figure::error() const {
  return reference == 0 ? std::abs(ours) : std::abs(ours - reference) / std::abs(reference);
}

void Largest::add(double error) {
  if (!(error <= value)) value = std::isnan(error) ? INFINITY : error;
}

std::span<const ProblemEntry> problems() { return kProblems; }

std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

}  // namespace vivify::validation
