// Writes the results as a document with one SVG per plot, drawn by gnuplot.
#pragma once

#include <filesystem>
#include <vector>

#include "bench/validation/problem.h"

namespace vivify::validation {

// `document` (Markdown) and its plots in the folder of the same name beside it. The same results give the
// same bytes. Throws Error(usage) when gnuplot is missing or fails.
void write_report(const std::vector<Result>& results, const std::filesystem::path& document);

}  // namespace vivify::validation
