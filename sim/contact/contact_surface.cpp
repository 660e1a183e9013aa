#include "sim/contact/contact_surface.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <vector>

#include "common/error.h"

namespace vivify::sim {
namespace {

// Edges of one triangle only, as the triangle goes round them; sorted.
RowMatrixXi rim_of(const RowMatrixXi& triangles) {
  std::map<std::array<int, 2>, std::array<int, 2>> open;
  for (Eigen::Index f = 0; f < triangles.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::array<int, 2> edge = {triangles(f, k), triangles(f, (k + 1) % 3)};
      const std::array<int, 2> key = {std::min(edge[0], edge[1]), std::max(edge[0], edge[1])};
      if (const auto [it, inserted] = open.emplace(key, edge); !inserted) open.erase(it);
    }
  }
  RowMatrixXi rim(static_cast<Eigen::Index>(open.size()), 2);
  Eigen::Index row = 0;
  for (const auto& [key, edge] : open) rim.row(row++) << edge[0], edge[1];
  return rim;
}

}  // namespace

RowMatrixXi edges_of(const RowMatrixXi& faces) {
  std::set<std::array<int, 2>> found;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({faces(f, k), faces(f, (k + 1) % 3)});
      found.insert({low, high});
    }
  }
  RowMatrixXi edges(static_cast<Eigen::Index>(found.size()), 2);
  Eigen::Index row = 0;
  for (const auto& [low, high] : found) edges.row(row++) << low, high;
  return edges;
}

ContactSurface boundary_of(const SimMesh& mesh, double radius) {
  ContactSurface surface;
  const int dimension = mesh.dimension(), corners = mesh.element_points();
  surface.two_sided = corners == dimension;
  if (mesh.E.rows() == 0) throw Error(ErrorKind::geometry, "a mesh without elements has no contact surface");
  if (surface.two_sided && !(radius > 0)) {
    throw Error(ErrorKind::geometry, "a shell or rod that touches bodies needs a thickness above zero");
  }
  surface.radius = surface.two_sided ? radius : 0;
  RowMatrixXi features;  // of vertices of the mesh
  if (surface.two_sided) {
    features = mesh.E;
  } else if (dimension == 2) {
    features = rim_of(mesh.E);
  } else {
    features = boundary_faces(TetMesh{Points(mesh.V), Tetrahedra(mesh.E)});
  }
  std::vector<int> point(static_cast<std::size_t>(mesh.V.rows()), -1);
  for (const int vertex : features.reshaped()) point[vertex] = 0;
  int count = 0;
  for (int& index : point) {
    if (index == 0) index = count++;
  }
  surface.points.dimension = dimension;
  surface.points.vertices.resize(count, 1);
  surface.points.weights.setOnes(count, 1);
  surface.rest.setZero(count, 3);
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
    if (point[v] < 0) continue;
    surface.points.vertices(point[v], 0) = static_cast<int>(v);
    surface.rest.row(point[v]).head(dimension) = mesh.V.row(v);
  }
  for (int& vertex : features.reshaped()) vertex = point[vertex];
  if (dimension == 2) {
    surface.edges = features;
  } else {
    surface.faces = features;
    surface.edges = edges_of(features);
  }
  return surface;
}

}  // namespace vivify::sim
