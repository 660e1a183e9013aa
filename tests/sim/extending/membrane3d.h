// A membrane in space, which stretches but does not bend:
//   W = Σ_t Σ_j (k_l/6) (l² − L²)² Ā/L̄⁴ + ½ k_a (a² − A²)² / Ā³.
#pragma once

#include <array>
#include <cmath>

#include "sim/elastic/models/models.h"
#include "tests/sim/extending/squared_area.h"

namespace vivify::sim {

inline Schema membrane3d_schema() {
  return object("A membrane in space: it resists stretch and change of area, and bends freely.")
      .field("density", number("Mass per area.").unit("kg/m²").above(0).initially(10))
      .field("stiffness", number("Edge stiffness k_l.").unit("N/m").above(0).initially(10000))
      .field("volume_stiffness",
             number("Stiffness k_a against change of area.").unit("N/m").at_least(0).initially(5000));
}

inline ElasticModel build_membrane3d(const SimMesh& reference, RestLayout layout,
                                     const Materials& materials) {
  const Eigen::VectorXd areas = positive_sizes(reference);
  auto edges = make_family("edge_length_3d"), area = make_squared_area(Kernels::packets);
  for (int t = 0; t < static_cast<int>(reference.E.rows()); ++t) {
    const Value& material = materials.of(t);
    std::array<int, 3> corner, rest;
    for (int k = 0; k < 3; ++k) {
      corner[k] = reference.E(t, k);
      rest[k] = simplex_rest_point(reference, layout, t, k);
    }
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      const double length2 = (reference.V.row(corner[i]) - reference.V.row(corner[j])).squaredNorm();
      edges->add(std::array{corner[i], corner[j]}, std::array{rest[i], rest[j]},
                 material["stiffness"].as_number() / 6 * 2 * areas[t] / (length2 * length2));
    }
    area->add(corner, rest, material["volume_stiffness"].as_number() / std::pow(areas[t], 3));
  }
  ElasticModel model;
  model.families.push_back(std::move(edges));
  model.families.push_back(std::move(area));
  model.rest = simplex_rest_points(reference, layout);
  model.rest.centre_edge = layout == RestLayout::incompatible;  // triangles in space are aligned by an edge
  model.mass = model_mass(reference, areas, materials);
  return model;
}

inline std::string membrane3d_warning(const Value&) { return {}; }

inline constexpr ModelEntry kMembrane3d = {"membrane3d",      3, 3, membrane3d_schema, build_membrane3d,
                                           membrane3d_warning};

}  // namespace vivify::sim
