// Solids of Green strain and size, Coros et al. 2012, Appendix A:
//   W = Σ_e ½ k_l ‖E‖² Ā + ½ k_a (a − A)² / Ā,
// in the plane and, as the "straightforward extension", in space. E is measured in the reference metric
// (Martin et al. 2011): E = Ē(x) − Ē(X); `solid2d_printed` takes F = S(x) S(X)⁻¹ as printed.
#include <numbers>

#include "sim/elastic/materials.h"
#include "sim/elastic/models/models.h"

namespace vivify::sim {
namespace {

// Least k_a and k_v as a share of k_l for which no element has a stable inverted state: 1/6 in the plane and
// (2√2 − 1)/7 in space (docs/validation.md).
constexpr double kLeastAreaShare = 1.0 / 6;
constexpr double kLeastVolumeShare = (2 * std::numbers::sqrt2 - 1) / 7;

ElasticModel build(const SimMesh& reference, RestLayout layout, const Materials& materials,
                   const char* strain_measure, const char* size_measure,
                   Stiffness (*stiffness)(const Value&)) {
  const Eigen::VectorXd sizes = positive_sizes(reference);
  auto strain = make_family(strain_measure), size = make_family(size_measure);
  const int points = reference.element_points();
  std::vector<int> corner(static_cast<std::size_t>(points)), rest(corner);
  for (int e = 0; e < static_cast<int>(reference.E.rows()); ++e) {
    const Stiffness k = stiffness(materials.of(e));
    for (int n = 0; n < points; ++n) {
      corner[static_cast<std::size_t>(n)] = reference.E(e, n);
      rest[static_cast<std::size_t>(n)] = simplex_rest_point(reference, layout, e, n);
    }
    strain->add(corner, rest, k.stretch * sizes[e], inverse_edge_matrix(reference, e));
    size->add(corner, rest, k.size / sizes[e]);
  }
  ElasticModel model;
  model.families.push_back(std::move(strain));
  model.families.push_back(std::move(size));
  model.rest = simplex_rest_points(reference, layout);
  model.mass = model_mass(reference, sizes, materials);
  return model;
}

}  // namespace

Schema solid2d_schema() {
  return with_poisson(
      object("A solid of the plane: Green strain and change of area (Appendix A, Solid2D). Stiffness is per "
             "depth: N/m.")
          .field("density", number("Mass per area.").unit("kg/m²").above(0).initially(300))
          .field("stiffness",
                 number("Stiffness k_l against Green strain. A character of height L is lively at about 30 · "
                        "density · 9.81 · L.")
                     .unit("N/m")
                     .above(0)
                     .initially(90000))
          .field(
              "volume_stiffness",
              number("Stiffness k_a against change of area; below k_l/6 single elements can stay inverted.")
                  .unit("N/m")
                  .at_least(0)
                  .initially(90000)),
      "N/m");
}

Schema solid3d_stvk_schema() {
  return with_poisson(
      object("A solid of Green strain and change of volume: the extension of the plane solid to space.")
          .field("density", number("Mass per volume.").unit("kg/m³").above(0).initially(300))
          .field("stiffness",
                 number("Stiffness k_l against Green strain.").unit("Pa").above(0).initially(130000))
          .field("volume_stiffness", number("Stiffness k_v against change of volume; below 0.2612 k_l single "
                                            "elements can stay inverted.")
                                         .unit("Pa")
                                         .at_least(0)
                                         .initially(130000)),
      "Pa");
}

ElasticModel build_solid2d(const SimMesh& reference, RestLayout layout, const Materials& materials) {
  return build(reference, layout, materials, "green_strain_2d", "area", plane_solid_stiffness);
}
ElasticModel build_solid2d_printed(const SimMesh& reference, RestLayout layout, const Materials& materials) {
  return build(reference, layout, materials, "printed_green_strain", "area", plane_solid_stiffness);
}
ElasticModel build_solid3d_stvk(const SimMesh& reference, RestLayout layout, const Materials& materials) {
  return build(reference, layout, materials, "green_strain_3d", "volume", stvk_stiffness);
}

std::string solid2d_warning(const Value& material) {
  const Stiffness k = plane_solid_stiffness(material);
  if (k.size >= kLeastAreaShare * k.stretch) return {};
  return "volume_stiffness is below a sixth of stiffness: triangles can stay turned inside out";
}

std::string solid3d_stvk_warning(const Value& material) {
  const Stiffness k = stvk_stiffness(material);
  if (k.size >= kLeastVolumeShare * k.stretch) return {};
  return "volume_stiffness is below 0.2612 times stiffness: tetrahedra can stay turned inside out";
}

}  // namespace vivify::sim
