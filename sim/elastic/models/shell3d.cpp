// Thin shells, Coros et al. 2012, Appendix A (by analogy with its curves and its tetrahedra) with the hinges
// of Grinspun et al. 2003:
//   W = Σ_t Σ_j (k_l/6) (l² − L²)² Ā/L̄⁴ + Σ_hinges ½ k_b (θ − Θ)² 3 ē²/Ā,   Ā the area of both triangles.
// With `bending_scaling: paper` the weight of a hinge is its share Ā/3 of the area, as the printed rod has T̄.
#include <map>

#include "sim/elastic/materials.h"
#include "sim/elastic/models/models.h"

namespace vivify::sim {
namespace {

struct Hinge {
  int edge[2];                 // vertices, as the first triangle runs through them
  int triangle[2] = {-1, -1};  // the second is -1 at a border
  int opposite[2] = {-1, -1};  // vertex
};

std::vector<Hinge> hinges_of(const SimMesh& mesh) {
  std::map<std::pair<int, int>, Hinge> hinges;
  for (int t = 0; t < static_cast<int>(mesh.E.rows()); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.E(t, k), b = mesh.E(t, (k + 1) % 3), c = mesh.E(t, (k + 2) % 3);
      const auto [it, fresh] = hinges.try_emplace(std::minmax(a, b), Hinge{{a, b}});
      Hinge& hinge = it->second;
      const int side = fresh ? 0 : 1;
      if (!fresh && (hinge.triangle[1] >= 0 || hinge.edge[0] == a)) {
        throw Error(ErrorKind::geometry,
                    "edge " + std::to_string(a) + "-" + std::to_string(b) +
                        " of the shell has more than two triangles, or two that face opposite ways",
                    "a shell must be a manifold with all triangles facing the same way");
      }
      hinge.triangle[side] = t;
      hinge.opposite[side] = c;
    }
  }
  std::vector<Hinge> sorted;
  for (const auto& [key, hinge] : hinges) sorted.push_back(hinge);
  return sorted;
}

}  // namespace

Schema shell3d_schema() {
  return with_thickness(
      with_bending_scaling(
          object("A thin shell that stretches and bends (Appendix A, with dihedral angles).")
              .field("density", number("Mass per area.").unit("kg/m²").above(0).initially(10))
              .field("stiffness",
                     number("Stretch stiffness k_l; three quarters of Young's modulus times thickness.")
                         .unit("N/m")
                         .above(0)
                         .initially(10000))
              .field(
                  "bending_stiffness",
                  number("Stiffness k_b of hinges, N m when consistent; a strip bends with about 8/3 of it.")
                      .at_least(0)
                      .initially(20))),
      "Pa");
}

ElasticModel build_shell3d(const SimMesh& reference, RestLayout layout, const Materials& materials) {
  const Eigen::VectorXd areas = positive_sizes(reference);
  auto stretch = make_family("edge_length_3d"), bend = make_family("dihedral_angle");
  ElasticModel model;
  model.rest = simplex_rest_points(reference, RestLayout::compatible);
  if (layout == RestLayout::incompatible) {
    model.rest = {};
    model.rest.centre_edge = true;
  }
  for (const Hinge& hinge : hinges_of(reference)) {
    const double length2 = (reference.V.row(hinge.edge[0]) - reference.V.row(hinge.edge[1])).squaredNorm();
    double stretching = 0, bending = 0, area = 0;
    int sides = 0;
    for (const int t : hinge.triangle) {
      if (t < 0) continue;
      const Stiffness k = shell_stiffness(materials.of(t));
      stretching += k.stretch / 3 * areas[t] / (length2 * length2);
      bending += k.bending;
      area += areas[t];
      ++sides;
    }
    std::vector<int> corner = {hinge.edge[0], hinge.edge[1], hinge.opposite[0]};
    if (sides == 2) corner.push_back(hinge.opposite[1]);
    std::vector<int> rest = corner;
    if (layout == RestLayout::incompatible) {
      model.rest.element_begin.push_back(model.rest.size());
      for (std::size_t k = 0; k < corner.size(); ++k) {
        rest[k] = model.rest.size();
        model.rest.vertex.push_back(corner[k]);
      }
    }
    stretch->add(std::span(corner).first(2), std::span(rest).first(2), stretching);
    if (sides < 2) continue;
    const double k = bending / 2;
    const bool printed = printed_bending(materials.of(hinge.triangle[0]));
    bend->add(corner, rest, printed ? k * area / 3 : k * 3 * length2 / area);
  }
  if (layout == RestLayout::incompatible) model.rest.element_begin.push_back(model.rest.size());
  model.families.push_back(std::move(stretch));
  model.families.push_back(std::move(bend));
  model.mass = model_mass(reference, areas, materials);
  return model;
}

std::string shell3d_warning(const Value&) { return {}; }

}  // namespace vivify::sim
