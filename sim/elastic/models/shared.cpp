#include <Eigen/Dense>

#include "sim/elastic/models/models.h"

namespace vivify::sim {

std::string element_name(const SimMesh& mesh, Eigen::Index e) {
  const int points = mesh.element_points();
  return (points == 2 ? "edge " : points == 3 ? "triangle " : "tetrahedron ") + std::to_string(e);
}

Eigen::VectorXd positive_sizes(const SimMesh& mesh) {
  Eigen::VectorXd sizes = element_sizes(mesh);
  for (Eigen::Index e = 0; e < sizes.size(); ++e) {
    if (sizes[e] > 0) continue;
    throw Error(ErrorKind::geometry,
                element_name(mesh, e) + " of the simulation mesh has no size or is turned inside out",
                "mesh the character again with more vertices");
  }
  return sizes;
}

Eigen::VectorXd model_mass(const SimMesh& mesh, const Eigen::VectorXd& sizes, const Materials& materials) {
  Eigen::VectorXd element_mass(sizes.size());
  for (Eigen::Index e = 0; e < sizes.size(); ++e) {
    element_mass[e] = materials.of(static_cast<int>(e))["density"].as_number() * sizes[e];
  }
  return lumped_mass(mesh, element_mass);
}

RestPoints simplex_rest_points(const SimMesh& mesh, RestLayout layout) {
  RestPoints rest;
  if (layout == RestLayout::compatible) {
    for (int v = 0; v < mesh.V.rows(); ++v) rest.vertex.push_back(v);
    return rest;
  }
  for (Eigen::Index e = 0; e < mesh.E.rows(); ++e) {
    rest.element_begin.push_back(rest.size());
    for (int k = 0; k < mesh.element_points(); ++k) rest.vertex.push_back(mesh.E(e, k));
  }
  rest.element_begin.push_back(rest.size());
  return rest;
}

std::vector<double> inverse_edge_matrix(const SimMesh& mesh, int e) {
  const int d = mesh.dimension();
  Eigen::MatrixXd D(d, d);
  for (int k = 0; k < d; ++k) {
    D.col(k) = (mesh.V.row(mesh.E(e, k + 1)) - mesh.V.row(mesh.E(e, 0))).transpose();
  }
  const Eigen::MatrixXd inverse = D.inverse();
  return {inverse.data(), inverse.data() + inverse.size()};
}

Schema with_bending_scaling(Schema material) {
  return std::move(material).field(
      "bending_scaling",
      choice("How the stiffness of a joint scales with the mesh: `consistent` gives the same bending for any "
             "resolution; `paper` is the printed form, which vanishes under refinement.",
             {"consistent", "paper"})
          .initially("consistent"));
}

bool printed_bending(const Value& material) { return material["bending_scaling"].as_string() == "paper"; }

}  // namespace vivify::sim
