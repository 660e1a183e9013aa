#include "sim/elastic/measure_family.h"

#include <array>
#include <map>
#include <utility>

#include "common/registry.h"
#include "sim/elastic/family_of.h"

namespace vivify::sim {

void MeasureFamily::add(std::span<const int> deformed, std::span<const int> rest, double coefficient,
                        std::span<const double> constants) {
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
  coefficients_.resize(static_cast<Eigen::Index>(merged.size()));
  Eigen::Index i = 0;
  for (const auto& [stencils, coefficient] : merged) {
    stencils_[0].insert(stencils_[0].end(), stencils.first.begin(), stencils.first.end());
    stencils_[1].insert(stencils_[1].end(), stencils.second.begin(), stencils.second.end());
    coefficients_[i++] = coefficient;
  }
}

void MeasureFamily::reserve(SymmetricPattern& pattern) const {
  const int n = points_per_term();
  for (int i = 0; i < size(); ++i) pattern.couple(stencils_[0].data() + n * i, n);
}

void MeasureFamily::bind(const SymmetricPattern& pattern) {
  const int n = points_per_term();
  columns_.clear();
  turned_.clear();
  for (int i = 0; i < size(); ++i) {
    pattern.append_columns(stencils_[0].data() + n * i, n, columns_, turned_);
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
