// Curves of the plane, open or closed, Coros et al. 2012, Appendix A:
//   W = Σ_i ½ k_l (l² − L²)² / L̄³ + Σ_a ½ k_b (θ − Θ)² / T̄,   T̄ = ½ (L̄_i + L̄_j).
// The printed weight of bending is T̄ instead of 1/T̄, which vanishes under refinement; the printed 1/L³ takes
// the moving rest length, here the reference.
#include <map>

#include "sim/elastic/materials.h"
#include "sim/elastic/models/models.h"

namespace vivify::sim {
namespace {

// The edges that follow and precede each edge of a curve, or -1 at an open end.
struct Chain {
  std::vector<int> next, previous;
};

Chain link(const SimMesh& mesh) {
  std::map<int, int> starting, ending;  // vertex -> edge
  const auto once = [](std::map<int, int>& map, int vertex, int edge) {
    if (map.emplace(vertex, edge).second) return;
    throw Error(ErrorKind::geometry,
                "the rod branches or turns its direction at vertex " + std::to_string(vertex),
                "edges must follow one another, each from the end of the one before");
  };
  const int edges = static_cast<int>(mesh.E.rows());
  for (int e = 0; e < edges; ++e) {
    once(starting, mesh.E(e, 0), e);
    once(ending, mesh.E(e, 1), e);
  }
  Chain chain{std::vector<int>(static_cast<std::size_t>(edges), -1),
              std::vector<int>(static_cast<std::size_t>(edges), -1)};
  for (int e = 0; e < edges; ++e) {
    if (const auto it = starting.find(mesh.E(e, 1)); it != starting.end())
      chain.next[static_cast<std::size_t>(e)] = it->second;
    if (const auto it = ending.find(mesh.E(e, 0)); it != ending.end())
      chain.previous[static_cast<std::size_t>(e)] = it->second;
  }
  return chain;
}

}  // namespace

Schema rod2d_schema() {
  return with_thickness(
      with_bending_scaling(
          object("A curve of the plane that stretches and bends (Appendix A, Curve2D).")
              .field("density", number("Mass per length.").unit("kg/m").above(0).initially(20))
              .field("stiffness", number("Stretch stiffness k_l: a quarter of the force per strain.")
                                      .unit("N")
                                      .above(0)
                                      .initially(20000))
              .field("bending_stiffness",
                     number("Bending stiffness k_b: moment per curvature, N m², when consistent.")
                         .at_least(0)
                         .initially(60))),
      "N/m");
}

ElasticModel build_rod2d(const SimMesh& reference, RestLayout layout, const Materials& materials) {
  const Eigen::VectorXd lengths = positive_sizes(reference);
  const Chain chain = link(reference);
  auto stretch = make_family("edge_length_2d"), bend = make_family("turning_angle");
  ElasticModel model;
  model.rest = simplex_rest_points(reference, RestLayout::compatible);
  if (layout == RestLayout::incompatible) {
    model.rest = {};
    model.rest.centre_edge = true;
  }

  const int edges = static_cast<int>(reference.E.rows());
  const auto weight = [&](int e, int next) {
    const double T = 0.5 * (lengths[e] + lengths[next]);
    const Value &first = materials.of(e), &second = materials.of(next);
    const double k = 0.5 * (rod_stiffness(first).bending + rod_stiffness(second).bending);
    return printed_bending(first) ? k * T : k / T;
  };
  for (int e = 0; e < edges; ++e) {
    const int a = reference.E(e, 0), b = reference.E(e, 1);
    const int next = chain.next[static_cast<std::size_t>(e)];
    const int previous = chain.previous[static_cast<std::size_t>(e)];
    const double k = rod_stiffness(materials.of(e)).stretch / std::pow(lengths[e], 3);
    if (layout == RestLayout::compatible) {
      stretch->add(std::array{a, b}, std::array{a, b}, k);
      if (next >= 0) {
        const std::array joint = {a, b, reference.E(next, 1)};
        bend->add(joint, joint, weight(e, next));
      }
      continue;
    }
    // The element of an edge is the edge and its neighbours; each joint belongs half to either edge.
    const int point = model.rest.size();
    model.rest.element_begin.push_back(point);
    model.rest.vertex.insert(model.rest.vertex.end(), {a, b});
    stretch->add(std::array{a, b}, std::array{point, point + 1}, k);
    if (previous >= 0) {
      const int before = reference.E(previous, 0);
      model.rest.vertex.push_back(before);
      bend->add(std::array{before, a, b}, std::array{model.rest.size() - 1, point, point + 1},
                0.5 * weight(previous, e));
    }
    if (next >= 0) {
      const int after = reference.E(next, 1);
      model.rest.vertex.push_back(after);
      bend->add(std::array{a, b, after}, std::array{point, point + 1, model.rest.size() - 1},
                0.5 * weight(e, next));
    }
  }
  if (layout == RestLayout::incompatible) model.rest.element_begin.push_back(model.rest.size());
  model.families.push_back(std::move(stretch));
  model.families.push_back(std::move(bend));
  model.mass = model_mass(reference, lengths, materials);
  return model;
}

std::string rod2d_warning(const Value&) { return {}; }

}  // namespace vivify::sim
