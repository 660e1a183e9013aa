#include "sim/elastic/models.h"

#include <Eigen/Geometry>
#include <array>
#include <string>

#include "common/registry.h"

namespace vivify::sim {
namespace {

Schema solid3d_schema() {
  return object(
             "The simplified tetrahedron: change of squared edge lengths and of volume (Appendix A, "
             "Solid3D).")
      .field("density", number("Mass per volume.").unit("kg/m³").above(0).initially(300))
      .field("stiffness",
             number("Edge stiffness k_l. A character of height L is lively at about 45 · density · 9.81 · L.")
                 .unit("Pa")
                 .above(0)
                 .initially(130000))
      .field("volume_stiffness",
             number("Volume stiffness k_v; below 0.087 k_l single elements can stay inverted.")
                 .unit("Pa")
                 .at_least(0)
                 .initially(200000));
}

// W = Σ_e Σ_j (k_l/12) (l² − L²)² V̄/L̄⁴ + ½ k_v (v − V)² / V̄.
ElasticModel build_solid3d(const TetMesh& reference, RestLayout layout, const Value& material) {
  static constexpr std::array<std::array<int, 2>, 6> kEdges = {
      {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
  const double kl = material["stiffness"].as_number(), kv = material["volume_stiffness"].as_number();
  const Eigen::VectorXd volumes = tet_volumes(reference);
  ElasticModel model;
  model.push_back(make_edge_length_family());
  model.push_back(make_volume_family());
  for (int e = 0; e < static_cast<int>(reference.T.rows()); ++e) {
    if (!(volumes[e] > 0)) {
      throw Error(ErrorKind::geometry,
                  "tetrahedron " + std::to_string(e) + " of the simulation mesh has no volume",
                  "mesh the character again with more vertices");
    }
    const std::vector<int> corners = {reference.T(e, 0), reference.T(e, 1), reference.T(e, 2),
                                      reference.T(e, 3)};
    const auto rest = [&](int k) { return layout == RestLayout::compatible ? corners[k] : 4 * e + k; };
    for (const auto& [i, j] : kEdges) {
      const bool ordered = corners[i] < corners[j];
      const int a = ordered ? i : j, b = ordered ? j : i;
      const double length2 = (reference.V.row(corners[a]) - reference.V.row(corners[b])).squaredNorm();
      model[0]->add({corners[a], corners[b]}, {rest(a), rest(b)}, kl / 6 * volumes[e] / (length2 * length2));
    }
    model[1]->add(corners, {rest(0), rest(1), rest(2), rest(3)}, kv / volumes[e]);
  }
  for (const auto& family : model) family->merge_equal_terms();
  return model;
}

constexpr std::array<ModelEntry, 1> kModels = {{
    {"solid3d", solid3d_schema, build_solid3d},
}};

}  // namespace

std::span<const ModelEntry> elastic_models() { return kModels; }

Schema model_schema() {
  Schema schema =
      variant("Elastic model and material of a body.", "type").initially(kModels.front().name.data());
  for (const ModelEntry& entry : kModels)
    schema = std::move(schema).option(std::string(entry.name), entry.material_schema());
  return schema;
}

ElasticModel build_model(const TetMesh& reference, RestLayout layout, const Value& model) {
  return find_entry(elastic_models(), model["type"].as_string(), "elastic model")
      .build(reference, layout, model);
}

}  // namespace vivify::sim
