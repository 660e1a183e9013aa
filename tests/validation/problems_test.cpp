// Every validation problem keeps the tolerances of its figures.
#include <gtest/gtest.h>

#include "bench/validation/problem.h"

namespace vivify::validation {

// In the namespace of its type, for GoogleTest.
static void PrintTo(const ProblemEntry& problem, std::ostream* out) { *out << problem.name; }

namespace {

class Validation : public ::testing::TestWithParam<ProblemEntry> {};

TEST_P(Validation, KeepsItsTolerances) {
  const Result result = GetParam().run(Effort::quick);
  EXPECT_FALSE(result.figures.empty());
  EXPECT_FALSE(result.plots.empty());
  for (const Figure& figure : result.figures) {
    EXPECT_TRUE(figure.holds()) << figure.name << ": " << figure.ours << " beside " << figure.reference
                                << ", error " << figure.error() << " of " << figure.tolerance;
  }
}

INSTANTIATE_TEST_SUITE_P(Problems, Validation, ::testing::ValuesIn(problems().begin(), problems().end()),
                         [](const auto& problem) { return std::string(problem.param.name); });

}  // namespace
}  // namespace vivify::validation
