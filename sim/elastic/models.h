// Elastic models of Coros et al. 2012, Appendix A: each is a list of measures with coefficients.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "common/mesh.h"
#include "common/schema.h"
#include "sim/elastic/measure_family.h"

namespace vivify::sim {

using ElasticModel = std::vector<std::unique_ptr<MeasureFamily>>;

// Where the rest stencil of an element lives in the stacked rest shape: shared vertices (compatible), or four
// points of its own per element (incompatible, Section 5.1).
enum class RestLayout { compatible, incompatible };

struct ModelEntry {
  std::string_view name;
  Schema (*material_schema)();  // the settings `build` reads
  // Terms over the elements of `reference` (the barred geometry, constant). Throws Error(geometry).
  ElasticModel (*build)(const TetMesh& reference, RestLayout layout, const Value& material);
};

std::span<const ModelEntry> elastic_models();

// The setting `model` of a body: the model, its density and its material.
Schema model_schema();

// The elastic model that `model` (resolved with model_schema) names.
ElasticModel build_model(const TetMesh& reference, RestLayout layout, const Value& model);

}  // namespace vivify::sim
