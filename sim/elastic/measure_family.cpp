#include "sim/elastic/measure_family.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "common/registry.h"
#include "sim/elastic/family_of.h"

namespace vivify::sim {

void MeasureFamily::add(std::span<const int> deformed, std::span<const int> rest, double coefficient,
                        std::span<const double> constants) {
  const bool shared = size() > 0 && parameters() == 0 &&
                      std::equal(deformed.begin(), deformed.end(), stencils_[0].end() - points_per_term());
  if (!shared) {
    measured_.insert(measured_.end(), deformed.begin(), deformed.end());
    runs_.push_back(0);
  }
  runs_.back() = size() + 1;
  stencils_[0].insert(stencils_[0].end(), deformed.begin(), deformed.end());
  stencils_[1].insert(stencils_[1].end(), rest.begin(), rest.end());
  constants_.insert(constants_.end(), constants.begin(), constants.end());
  coefficients_.conservativeResize(coefficients_.size() + 1);
  coefficients_[coefficients_.size() - 1] = coefficient;
}

void MeasureFamily::merge_equal_terms() {
  const int n = points_per_term();
  std::map<std::pair<std::vector<int>, std::vector<int>>, double> merged;
  for (int i = 0; i < size(); ++i) {
    const auto begin = [&](int side) { return stencils_[side].begin() + n * i; };
    merged[{std::vector<int>(begin(0), begin(0) + n), std::vector<int>(begin(1), begin(1) + n)}] +=
        coefficients_[i];
  }
  stencils_[0].clear();
  stencils_[1].clear();
  coefficients_.resize(0);
  measured_.clear();
  runs_ = {0};
  for (const auto& [stencils, coefficient] : merged) add(stencils.first, stencils.second, coefficient);
}

const Eigen::VectorXd& MeasureFamily::sum_terms(Side side, const Eigen::VectorXd& numbers,
                                                Eigen::VectorXd& sums) const {
  const int stencils = stencil_count(side);
  if (stencils == size()) return numbers;
  const Eigen::Index m = numbers.size() / size();
  sums.resize(m * stencils);
  for (int i = 0; i < stencils; ++i) {
    const int begin = first_term(side, i), end = first_term(side, i + 1);
    for (Eigen::Index k = 0; k < m; ++k) {
      double sum = numbers[m * begin + k];
      for (int term = begin + 1; term < end; ++term) sum += numbers[m * term + k];
      sums[m * i + k] = sum;
    }
  }
  return sums;
}

void MeasureFamily::spread_to_terms(Side side, Eigen::VectorXd& values) const {
  const int stencils = stencil_count(side), m = components();
  if (stencils == size()) return;
  Eigen::VectorXd spread(value_count());
  for (int i = 0; i < stencils; ++i) {
    for (int term = first_term(side, i); term < first_term(side, i + 1); ++term) {
      for (int k = 0; k < m; ++k) spread[m * term + k] = values[m * i + k];
    }
  }
  values = std::move(spread);
}

void MeasureFamily::reserve(SymmetricPattern& pattern, int first_vertex) const {
  for (int i = 0; i < stencil_count(Side::deformed); ++i) {
    pattern.couple(stencil_of(Side::deformed, i), points_per_term(), first_vertex);
  }
}

void MeasureFamily::bind(const SymmetricPattern& pattern, int first_vertex) {
  columns_.clear();
  turned_.clear();
  for (int i = 0; i < stencil_count(Side::deformed); ++i) {
    pattern.append_columns(stencil_of(Side::deformed, i), points_per_term(), columns_, turned_, first_vertex);
  }
}

namespace {

constexpr std::array<MeasureEntry, 9> kMeasures = {{
    {"edge_length_2d", 2, make_edge_length_2d},
    {"edge_length_3d", 3, make_edge_length_3d},
    {"area", 2, make_area},
    {"volume", 3, make_volume},
    {"green_strain_2d", 2, make_green_strain_2d},
    {"green_strain_3d", 3, make_green_strain_3d},
    {"printed_green_strain", 2, make_printed_green_strain},
    {"turning_angle", 2, make_turning_angle},
    {"dihedral_angle", 3, make_dihedral_angle},
}};

}  // namespace

std::span<const MeasureEntry> measures() { return kMeasures; }

std::unique_ptr<MeasureFamily> make_family(std::string_view measure, Kernels kernels) {
  return find_entry(measures(), measure, "measure").make(kernels);
}

}  // namespace vivify::sim
