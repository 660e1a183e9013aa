// The elastic models, one file each; the registry is sim/elastic/models.cpp.
#pragma once

#include "sim/elastic/models.h"

namespace vivify::sim {

Schema solid3d_schema();
Schema solid3d_stvk_schema();
Schema shell3d_schema();
Schema solid2d_schema();
Schema rod2d_schema();

ElasticModel build_solid3d(const SimMesh&, RestLayout, const Materials&);
ElasticModel build_solid3d_stvk(const SimMesh&, RestLayout, const Materials&);
ElasticModel build_shell3d(const SimMesh&, RestLayout, const Materials&);
ElasticModel build_solid2d(const SimMesh&, RestLayout, const Materials&);
ElasticModel build_solid2d_printed(const SimMesh&, RestLayout, const Materials&);
ElasticModel build_rod2d(const SimMesh&, RestLayout, const Materials&);

std::string solid3d_warning(const Value& material);
std::string solid3d_stvk_warning(const Value& material);
std::string shell3d_warning(const Value& material);
std::string solid2d_warning(const Value& material);
std::string rod2d_warning(const Value& material);

// Parts that models share.

// "triangle 17": an element as messages name it.
std::string element_name(const SimMesh& mesh, Eigen::Index e);
// Sizes of the elements (#E), all of which must be positive. Throws Error(geometry) that names the element.
Eigen::VectorXd positive_sizes(const SimMesh& mesh);
// Mass of the vertices from the density of each element (per length, area or volume).
Eigen::VectorXd model_mass(const SimMesh& mesh, const Eigen::VectorXd& sizes, const Materials& materials);
// Rest points of a mesh of simplices: its vertices, or copies for every element.
RestPoints simplex_rest_points(const SimMesh& mesh, RestLayout layout);
// Rest point of corner k of element e in that layout.
inline int simplex_rest_point(const SimMesh& mesh, RestLayout layout, int e, int k) {
  return layout == RestLayout::compatible ? mesh.E(e, k) : mesh.element_points() * e + k;
}
// Entries of D̄⁻¹ of element e, column by column: the constants of the Green strain.
std::vector<double> inverse_edge_matrix(const SimMesh& mesh, int e);
// How the stiffness of bending scales with the mesh (`bending_scaling`): true for the printed form.
Schema with_bending_scaling(Schema material);
bool printed_bending(const Value& material);

}  // namespace vivify::sim
