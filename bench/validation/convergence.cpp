#include "bench/validation/convergence.h"

#include <cmath>

namespace vivify::validation {

Convergence converge(const std::vector<double>& n, const std::vector<double>& v) {
  const std::size_t k = n.size() - 3;
  const double wanted = (v[k] - v[k + 2]) / (v[k + 1] - v[k + 2]);
  const auto ratio = [&](double p) {
    const double last = std::pow(n[k + 2], -p);
    return (std::pow(n[k], -p) - last) / (std::pow(n[k + 1], -p) - last);
  };
  double low = 0.01, high = 10;  // the ratio rises with p
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (ratio(middle) < wanted ? low : high) = middle;
  }
  const double c = (v[k + 1] - v[k + 2]) / (std::pow(n[k + 1], -low) - std::pow(n[k + 2], -low));
  return {v[k + 2] - c * std::pow(n[k + 2], -low), low};
}

}  // namespace vivify::validation
