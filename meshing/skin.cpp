#include "meshing/skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace vivify::meshing {
namespace {

constexpr double kSharpestMitre = 0.5;  // least 1 + cos of the turn between two edges of a rod

// Normals of the vertices of a rod (#V by 2), to its left: mitred, so that both edges keep their thickness.
RowMatrixXd rod_normals(const Eigen::Ref<const RowMatrixXi>& E, const Eigen::Ref<const RowMatrixXd>& x) {
  RowMatrixXd first = RowMatrixXd::Zero(x.rows(), 2),
              second = first;  // of the edges that start and end there
  for (Eigen::Index e = 0; e < E.rows(); ++e) {
    const Eigen::RowVector2d along = (x.row(E(e, 1)) - x.row(E(e, 0))).normalized();
    const Eigen::RowVector2d normal(-along.y(), along.x());
    first.row(E(e, 0)) = normal;
    second.row(E(e, 1)) = normal;
  }
  RowMatrixXd normals(x.rows(), 2);
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    const bool joint = !first.row(i).isZero() && !second.row(i).isZero();
    const Eigen::RowVector2d sum = first.row(i) + second.row(i);
    normals.row(i) = joint ? sum / std::max(1 + first.row(i).dot(second.row(i)), kSharpestMitre) : sum;
  }
  return normals;
}

RowMatrixXd normals_of(const Eigen::Ref<const RowMatrixXi>& E, const Eigen::Ref<const RowMatrixXd>& x) {
  return x.cols() == 2 ? rod_normals(E, x) : RowMatrixXd(vertex_normals(Points(x), Triangles(E)));
}

// Index of an element that has the vertex, and the place of the vertex in it.
std::vector<std::array<int, 2>> elements_at(const Eigen::Ref<const RowMatrixXi>& E, Eigen::Index vertices) {
  std::vector<std::array<int, 2>> at(static_cast<std::size_t>(vertices), {0, 0});
  for (int e = static_cast<int>(E.rows()) - 1; e >= 0; --e) {
    for (int k = 0; k < E.cols(); ++k) at[static_cast<std::size_t>(E(e, k))] = {e, k};
  }
  return at;
}

}  // namespace

Embedding embed_vertices(const Eigen::Ref<const RowMatrixXi>& E, const Eigen::VectorXi& vertices) {
  const auto at = elements_at(E, E.size() == 0 ? 0 : E.maxCoeff() + 1);
  Embedding embedding;
  embedding.element.resize(vertices.size());
  embedding.weights = RowMatrixXd::Zero(vertices.size(), E.cols());
  for (Eigen::Index i = 0; i < vertices.size(); ++i) {
    const auto [element, corner] = at[static_cast<std::size_t>(vertices[i])];
    embedding.element[i] = element;
    embedding.weights(i, corner) = 1;
  }
  return embedding;
}

Embedding embed_edges(const Eigen::Ref<const RowMatrixXi>& E) {
  const auto corners = static_cast<int>(E.cols());
  std::vector<std::array<int, 3>> middles;  // element, place of one end in it, and of the other
  std::set<std::pair<int, int>> known;
  for (int e = 0; e < E.rows(); ++e) {
    for (int k = 0; k < (corners == 2 ? 1 : corners); ++k) {
      const int next = (k + 1) % corners;
      if (known.insert(std::minmax(E(e, k), E(e, next))).second) middles.push_back({e, k, next});
    }
  }
  const int vertices = E.size() == 0 ? 0 : E.maxCoeff() + 1;
  Embedding embedding = embed_vertices(E, Eigen::VectorXi::LinSpaced(vertices, 0, vertices - 1));
  const auto count = static_cast<Eigen::Index>(middles.size());
  embedding.element.conservativeResize(vertices + count);
  embedding.weights.conservativeResize(vertices + count, Eigen::NoChange);
  embedding.weights.bottomRows(count).setZero();
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto& [element, one, other] = middles[static_cast<std::size_t>(i)];
    embedding.element[vertices + i] = element;
    embedding.weights(vertices + i, one) = embedding.weights(vertices + i, other) = 0.5;
  }
  return embedding;
}

Points draw(const Skin& skin, const Eigen::Ref<const RowMatrixXi>& E,
            const Eigen::Ref<const RowMatrixXd>& x) {
  RowMatrixXd positions = interpolate(skin.embedding, E, x);
  if (skin.offset.size() > 0) {
    positions += skin.offset.asDiagonal() * interpolate(skin.embedding, E, normals_of(E, x));
  }
  Points drawn(positions.rows(), 3);
  drawn.leftCols(positions.cols()) = positions;
  if (positions.cols() == 2) drawn.col(2) = skin.depth;
  return drawn;
}

SkinnedSurface rod_band(const Points2& V, const Edges& E, double thickness, double depth, double bevel,
                        double z) {
  const double a = thickness / 2, b = depth / 2, c = std::clamp(bevel, 0.0, 0.9 * std::min(a, b));
  // The section, seen along the rod: offset to the left of it, and depth.
  std::vector<std::array<double, 2>> section;
  if (c > 0) {
    section = {{a, b - c},  {a - c, b},  {c - a, b},  {-a, b - c},
               {-a, c - b}, {c - a, -b}, {a - c, -b}, {a, c - b}};
  } else {
    section = {{a, b}, {-a, b}, {-a, -b}, {a, -b}};
  }
  const int corners = static_cast<int>(section.size()), vertices = static_cast<int>(V.rows());
  SkinnedSurface result;
  Eigen::VectorXi vertex(vertices * corners);
  result.skin.offset.resize(vertex.size());
  result.skin.depth.resize(vertex.size());
  for (int i = 0; i < vertices; ++i) {
    for (int k = 0; k < corners; ++k) {
      vertex[i * corners + k] = i;
      result.skin.offset[i * corners + k] = section[static_cast<std::size_t>(k)][0];
      result.skin.depth[i * corners + k] = z + section[static_cast<std::size_t>(k)][1];
    }
  }
  std::vector<Eigen::RowVector3i> faces;
  std::vector<int> starts(static_cast<std::size_t>(vertices)), ends(starts);
  for (Eigen::Index e = 0; e < E.rows(); ++e) {
    ++starts[static_cast<std::size_t>(E(e, 0))];
    ++ends[static_cast<std::size_t>(E(e, 1))];
    for (int k = 0; k < corners; ++k) {
      const int next = (k + 1) % corners, from = E(e, 0) * corners, to = E(e, 1) * corners;
      faces.emplace_back(from + k, from + next, to + k);
      faces.emplace_back(to + k, from + next, to + next);
    }
  }
  for (int i = 0; i < vertices; ++i) {
    const bool first = ends[static_cast<std::size_t>(i)] == 0,
               last = starts[static_cast<std::size_t>(i)] == 0;
    for (int k = 1; k + 1 < corners && (first || last); ++k) {
      const int o = i * corners;
      faces.emplace_back(o, first ? o + k + 1 : o + k, first ? o + k : o + k + 1);
    }
  }
  result.surface.F.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f)
    result.surface.F.row(static_cast<Eigen::Index>(f)) = faces[f];
  result.skin.embedding = embed_vertices(E, vertex);
  result.surface.V = draw(result.skin, E, V);
  return result;
}

SkinnedSurface thick_shell(const TriangleMesh& surface, const Eigen::VectorXi& vertex, const Points& V,
                           const Triangles& F, double thickness) {
  const auto count = static_cast<int>(surface.V.rows()), faces = static_cast<int>(surface.F.rows());
  // Edges of the simulated triangles that have a triangle on one side only, with their drawn vertices.
  std::map<std::pair<int, int>, int> uses;
  for (int f = 0; f < faces; ++f) {
    for (int k = 0; k < 3; ++k) ++uses[std::minmax(F(f, k), F(f, (k + 1) % 3))];
  }
  std::vector<Eigen::RowVector3i> triangles;
  std::vector<int> face;  // whose part each has
  for (int f = 0; f < faces; ++f) {
    triangles.emplace_back(surface.F.row(f));
    face.push_back(f);
  }
  for (int f = 0; f < faces; ++f) {
    triangles.emplace_back(surface.F(f, 0) + count, surface.F(f, 2) + count, surface.F(f, 1) + count);
    face.push_back(f);
  }
  for (int f = 0; f < faces; ++f) {
    for (int k = 0; k < 3; ++k) {
      if (uses[std::minmax(F(f, k), F(f, (k + 1) % 3))] != 1) continue;
      const int a = surface.F(f, k), b = surface.F(f, (k + 1) % 3);
      triangles.emplace_back(a, a + count, b);
      triangles.emplace_back(b, a + count, b + count);
      face.insert(face.end(), 2, f);
    }
  }

  SkinnedSurface result;
  result.surface.part_names = surface.part_names;
  result.surface.F.resize(static_cast<Eigen::Index>(triangles.size()), 3);
  const bool parts = surface.face_part.size() > 0;
  if (parts) result.surface.face_part.resize(result.surface.F.rows());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto row = static_cast<Eigen::Index>(t);
    result.surface.F.row(row) = triangles[t];
    if (parts) result.surface.face_part[row] = surface.face_part[face[t]];
  }
  if (surface.UV.rows() > 0) {
    result.surface.UV.resize(2 * count, 2);
    result.surface.UV << surface.UV, surface.UV;
  }
  Eigen::VectorXi both(2 * count);
  both << vertex, vertex;
  result.skin.embedding = embed_vertices(F, both);
  result.skin.offset.resize(2 * count);
  result.skin.offset << Eigen::VectorXd::Constant(count, thickness / 2),
      Eigen::VectorXd::Constant(count, -thickness / 2);
  result.surface.V = draw(result.skin, F, V);
  return result;
}

}  // namespace vivify::meshing
