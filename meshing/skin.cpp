#include "meshing/skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "meshing/closest_point.h"

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

// The nearest point of the triangles for every point (#P by 3), and how far it lies on the side of the
// normal.
std::pair<Embedding, Eigen::VectorXd> follow_triangles(const Points& points, const Points& V,
                                                       const Triangles& F) {
  const ClosestPoint nearest({V, F, {}, {}, {}});
  const Points normals = vertex_normals(V, F);
  Embedding embedding;
  embedding.element.resize(points.rows());
  embedding.weights.resize(points.rows(), 3);
  Eigen::VectorXd distance(points.rows());
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Eigen::Vector3d p = points.row(i);
    const ClosestPoint::Hit hit = nearest(p);
    const Eigen::Vector3d a = V.row(F(hit.triangle, 0)), b = V.row(F(hit.triangle, 1)),
                          c = V.row(F(hit.triangle, 2)), n = (b - a).cross(c - a);
    Eigen::Vector3d weights((c - b).cross(hit.point - b).dot(n), (a - c).cross(hit.point - c).dot(n),
                            (b - a).cross(hit.point - a).dot(n));
    weights = weights.cwiseMax(0);
    weights /= weights.sum();
    embedding.element[i] = hit.triangle;
    embedding.weights.row(i) = weights.transpose();
    const Eigen::Vector3d normal = weights[0] * normals.row(F(hit.triangle, 0)) +
                                   weights[1] * normals.row(F(hit.triangle, 1)) +
                                   weights[2] * normals.row(F(hit.triangle, 2));
    distance[i] = (p - hit.point).dot(normal);
  }
  return {std::move(embedding), std::move(distance)};
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

SkinnedSurface thick_shell(const TriangleMesh& surface, const Points& V, const Triangles& F,
                           double thickness) {
  const auto count = static_cast<int>(surface.V.rows());
  const auto [embedding, distance] = follow_triangles(surface.V, V, F);
  const RowMatrixXd normals = interpolate(embedding, F, vertex_normals(V, F));

  // Vertices in the same place count as one where borders are looked for.
  std::map<std::array<double, 3>, int> places;
  std::vector<int> place;
  for (const auto& v : surface.V.rowwise()) {
    place.push_back(
        places.emplace(std::array{v[0], v[1], v[2]}, static_cast<int>(places.size())).first->second);
  }
  const auto edge_of = [&](const Eigen::RowVector3i& f, int k) {
    return std::minmax(place[static_cast<std::size_t>(f[k])],
                       place[static_cast<std::size_t>(f[(k + 1) % 3])]);
  };
  // The drawn triangles, turned to face as the simulated ones.
  std::vector<Eigen::RowVector3i> front;
  std::vector<int> source;
  std::map<std::pair<int, int>, int> uses;
  for (int f = 0; f < static_cast<int>(surface.F.rows()); ++f) {
    Eigen::RowVector3i face = surface.F.row(f);
    const Eigen::Vector3d a = surface.V.row(face[0]), b = surface.V.row(face[1]), c = surface.V.row(face[2]);
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    if (normal.isZero(0)) continue;
    const Eigen::RowVector3d side = normals.row(face[0]) + normals.row(face[1]) + normals.row(face[2]);
    if (normal.dot(side.transpose()) < 0) std::swap(face[1], face[2]);
    front.push_back(face);
    source.push_back(f);
    for (int k = 0; k < 3; ++k) ++uses[edge_of(face, k)];
  }

  std::vector<Eigen::RowVector3i> triangles = front;
  std::vector<int> face = source;  // whose part each has
  for (std::size_t i = 0; i < front.size(); ++i) {
    triangles.emplace_back(front[i][0] + count, front[i][2] + count, front[i][1] + count);
    face.push_back(source[i]);
  }
  for (std::size_t i = 0; i < front.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      if (uses[edge_of(front[i], k)] != 1) continue;
      const int a = front[i][k], b = front[i][(k + 1) % 3];
      triangles.emplace_back(a, a + count, b);
      triangles.emplace_back(b, a + count, b + count);
      face.insert(face.end(), 2, source[i]);
    }
  }

  SkinnedSurface result;
  result.surface.part_names = surface.part_names;
  result.surface.F.resize(std::ssize(triangles), 3);
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
  result.skin.embedding.element.resize(2 * count);
  result.skin.embedding.element << embedding.element, embedding.element;
  result.skin.embedding.weights.resize(2 * count, 3);
  result.skin.embedding.weights << embedding.weights, embedding.weights;
  result.skin.offset.resize(2 * count);
  result.skin.offset << distance.array() + thickness / 2, distance.array() - thickness / 2;
  result.surface.V = draw(result.skin, F, V);
  return result;
}

}  // namespace vivify::meshing
