#include "meshing/main_body.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "meshing/quality.h"

namespace vivify::meshing {
namespace {

constexpr double kSmallVolume = 0.02;  // of the largest part
constexpr double kBoxMargin = 0.1;     // of its size

// For every vertex, the lowest vertex it is connected with.
std::vector<int> connected_vertices(const TriangleMesh& surface) {
  std::vector<int> parent(static_cast<std::size_t>(surface.V.rows()));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (Eigen::Index f = 0; f < surface.F.rows(); ++f) {
    for (int k = 1; k < 3; ++k) {
      const auto [low, high] = std::minmax({root(surface.F(f, 0)), root(surface.F(f, k))});
      parent[high] = low;
    }
  }
  for (int v = 0; v < static_cast<int>(parent.size()); ++v) parent[v] = root(v);
  return parent;
}

// The given faces of a surface, with the vertices they use.
TriangleMesh only(const TriangleMesh& surface, const std::vector<Eigen::Index>& faces) {
  TriangleMesh part;
  part.V = surface.V;
  part.F.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t i = 0; i < faces.size(); ++i)
    part.F.row(static_cast<Eigen::Index>(i)) = surface.F.row(faces[i]);
  drop_unused_vertices(part);
  return part;
}

}  // namespace

TriangleMesh main_body(const TriangleMesh& surface, std::vector<std::string>& notes) {
  const std::vector<int> part_of_vertex = connected_vertices(surface);
  std::map<int, std::vector<Eigen::Index>> faces_of_part;
  for (Eigen::Index f = 0; f < surface.F.rows(); ++f)
    faces_of_part[part_of_vertex[surface.F(f, 0)]].push_back(f);
  if (faces_of_part.size() < 2) return surface;

  std::vector<TriangleMesh> parts;
  std::vector<double> volumes;
  for (const auto& [vertex, faces] : faces_of_part) {
    parts.push_back(only(surface, faces));
    volumes.push_back(std::abs(signed_volume(parts.back())));
  }
  const std::size_t largest =
      static_cast<std::size_t>(std::max_element(volumes.begin(), volumes.end()) - volumes.begin());
  if (!is_closed_oriented(parts[largest].F)) return surface;
  Box room = bounding_box(parts[largest].V);
  const Eigen::Vector3d margin = kBoxMargin * (room.max - room.min);
  room = {room.min - margin, room.max + margin};

  std::vector<Eigen::Index> kept;
  int left_out = 0;
  std::size_t index = 0;
  for (const auto& [vertex, faces] : faces_of_part) {
    const Box box = bounding_box(parts[index].V);
    const bool inside =
        (box.min.array() >= room.min.array()).all() && (box.max.array() <= room.max.array()).all();
    if (index != largest && inside && volumes[index] < kSmallVolume * volumes[largest]) {
      ++left_out;
    } else {
      kept.insert(kept.end(), faces.begin(), faces.end());
    }
    ++index;
  }
  if (left_out == 0) return surface;
  std::sort(kept.begin(), kept.end());
  notes.push_back("left " + std::to_string(left_out) + " small separate part" + (left_out > 1 ? "s" : "") +
                  " out of the simulation: drawn, and carried along by the body");
  return only(surface, kept);
}

}  // namespace vivify::meshing
