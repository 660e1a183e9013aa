// What every entry of the registries of sim/ must fulfil, as suites over entries: instantiated over all of
// them in *_conformance_test.cpp, and over the example of docs/extending.md in extending_test.cpp.
#pragma once

#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

#include "tests/sim/fixtures.h"

namespace vivify::sim {

// measure_conformance_test.cpp: derivatives, invariance, kernels, and the law of the family.
class MeasureConformance : public ::testing::TestWithParam<MeasureEntry> {};
std::string measure_name(const ::testing::TestParamInfo<MeasureEntry>& tested);

// model_conformance_test.cpp: forces and stiffness, invariance of either shape, layouts, material.
struct ModelCase {
  ModelEntry model;
  NamedMesh mesh;
};
std::vector<ModelCase> model_cases(std::span<const ModelEntry> models);
std::string model_name(const ::testing::TestParamInfo<ModelCase>& tested);
class ModelConformance : public ::testing::TestWithParam<ModelCase> {};

// rest_space_conformance_test.cpp: X(0) = X₀, derivatives, no direction without effect.
class RestSpaceConformance : public ::testing::TestWithParam<BodyCase> {};

// step_conformance_test.cpp: all blocks of (13), their elimination, and the step methods.
class StepConformance : public ::testing::TestWithParam<BodyCase> {};

// How a failing case is printed.
inline void PrintTo(const MeasureEntry& entry, std::ostream* out) { *out << entry.name; }
inline void PrintTo(const ModelCase& tested, std::ostream* out) {
  *out << tested.model.name << " on a " << tested.mesh.name;
}

}  // namespace vivify::sim
