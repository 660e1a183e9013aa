// The limit and the order of a quantity that was computed on finer and finer meshes.
#pragma once

#include <vector>

namespace vivify::validation {

// v(n) = limit + c n^(−order), through the last three points.
struct Convergence {
  double limit = 0, order = 0;
};
Convergence converge(const std::vector<double>& n, const std::vector<double>& v);

}  // namespace vivify::validation
