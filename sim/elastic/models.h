// Elastic models of Coros et al. 2012, Appendix A: each is a list of measures with coefficients.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/mesh.h"
#include "common/schema.h"
#include "sim/elastic/measure_family.h"

namespace vivify::sim {

// Where the rest stencil of an element lives in the stacked rest shape: shared vertices (compatible), or
// points of its own per element (incompatible, Section 5.1).
enum class RestLayout { compatible, incompatible };

// The points of the stacked rest shape, each a copy of a vertex. In the incompatible layout they form
// elements that are registered one by one: simplices by polar decomposition; elements round a centre edge
// (their first two points) by aligning that edge (Section 5.2).
struct RestPoints {
  std::vector<int> vertex;         // of each point
  std::vector<int> element_begin;  // point where each element begins, and the end
  bool centre_edge = false;        // elements are registered by their first two points
  int size() const { return static_cast<int>(vertex.size()); }
};

using ElasticFamilies = std::vector<std::unique_ptr<MeasureFamily>>;

struct ElasticModel {
  ElasticFamilies families;
  RestPoints rest;
  Eigen::VectorXd mass;  // #V, kg, lumped
};

// The material of each element: that of the last region that holds its centre, else the body's own.
class Materials {
 public:
  Materials(const SimMesh& reference, const Value& model);
  const Value& of(int element) const;

 private:
  const Value& model_;
  std::vector<int> region_;  // of each element, or -1
};

struct ModelEntry {
  std::string_view name;
  int dimension;       // of the points
  int element_points;  // 2: edges, 3: triangles, 4: tetrahedra
  Schema (*material_schema)();
  // Terms over the elements of `reference` (the barred geometry, constant). Throws Error(geometry).
  ElasticModel (*build)(const SimMesh& reference, RestLayout layout, const Materials& materials);
  // What is wrong with a material, in words; empty when nothing is.
  std::string (*warning)(const Value& material);
};

std::span<const ModelEntry> elastic_models();
const ModelEntry& model_entry(const Value& model);

// The setting `model` of a body: the model (one of `models`), its density and its material.
Schema model_schema(std::span<const ModelEntry> models = elastic_models());

// The elastic model that `model` (resolved with model_schema) names. Throws Error(geometry) for a mesh of
// another kind or with degenerate elements.
ElasticModel build_model(const SimMesh& reference, RestLayout layout, const Value& model);
ElasticModel build_model(const ModelEntry& entry, const SimMesh& reference, RestLayout layout,
                         const Value& model);

// Warnings about the material and its regions, such as ratios that let an element stay inverted.
std::vector<std::string> model_warnings(const Value& model);

}  // namespace vivify::sim
