// The simplified tetrahedron of Coros et al. 2012, Appendix A:
//   W = Σ_e Σ_j (k_l/12) (l² − L²)² V̄/L̄⁴ + ½ k_v (v − V)² / V̄.
#include "sim/elastic/materials.h"
#include "sim/elastic/models/models.h"

namespace vivify::sim {

// Below this share of k_l a single regular tetrahedron has a stable inverted state (measured 0.087; see
// docs/validation.md).
constexpr double kLeastVolumeShare = 0.1;

Schema solid3d_schema() {
  return with_poisson(
      object("The simplified tetrahedron: change of squared edge lengths and of volume (Appendix A, "
             "Solid3D).")
          .field("density", number("Mass per volume.").unit("kg/m³").above(0).initially(300))
          .field(
              "stiffness",
              number(
                  "Edge stiffness k_l. A character of height L is lively at about 45 · density · 9.81 · L.")
                  .unit("Pa")
                  .above(0)
                  .initially(130000))
          .field("volume_stiffness",
                 number("Volume stiffness k_v; below 0.1 k_l single elements can stay inverted.")
                     .unit("Pa")
                     .at_least(0)
                     .initially(200000)),
      "Pa");
}

ElasticModel build_solid3d(const SimMesh& reference, RestLayout layout, const Materials& materials) {
  static constexpr int kEdges[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
  const Eigen::VectorXd volumes = positive_sizes(reference);
  auto edges = make_family("edge_length_3d"), volume = make_family("volume");
  for (int e = 0; e < static_cast<int>(reference.E.rows()); ++e) {
    const Stiffness k = simplified_solid_stiffness(materials.of(e));
    int corner[4], rest[4];
    for (int n = 0; n < 4; ++n) {
      corner[n] = reference.E(e, n);
      rest[n] = simplex_rest_point(reference, layout, e, n);
    }
    for (const auto& [i, j] : kEdges) {
      const int a = corner[i] < corner[j] ? i : j, b = a == i ? j : i;
      const double length2 = (reference.V.row(corner[a]) - reference.V.row(corner[b])).squaredNorm();
      edges->add(std::array{corner[a], corner[b]}, std::array{rest[a], rest[b]},
                 k.stretch / 6 * volumes[e] / (length2 * length2));
    }
    volume->add(corner, rest, k.size / volumes[e]);
  }
  edges->merge_equal_terms();
  volume->merge_equal_terms();
  ElasticModel model;
  model.families.push_back(std::move(edges));
  model.families.push_back(std::move(volume));
  model.rest = simplex_rest_points(reference, layout);
  model.mass = model_mass(reference, volumes, materials);
  return model;
}

std::string solid3d_warning(const Value& material) {
  const Stiffness k = simplified_solid_stiffness(material);
  if (k.size >= kLeastVolumeShare * k.stretch) return {};
  return "volume_stiffness is below a tenth of stiffness: tetrahedra can stay turned inside out";
}

}  // namespace vivify::sim
