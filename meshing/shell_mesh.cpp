#include "meshing/shell_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "common/error.h"
#include "common/text.h"
#include "meshing/byte_stream.h"
#include "meshing/coarsen.h"
#include "meshing/guarded_process.h"
#include "meshing/quality.h"
#include "meshing/surface_checks.h"

namespace vivify::meshing {
namespace {

constexpr double kCountTolerance = 0.15;
constexpr double kEnough = 0.03;  // the search for the edge length ends this near to the wanted number

std::string place(const TriangleMesh& mesh, int v) {
  return "(" + number_text(mesh.V(v, 0)) + ", " + number_text(mesh.V(v, 1)) + ", " +
         number_text(mesh.V(v, 2)) + ")";
}

double doubled_area(const TriangleMesh& mesh, Eigen::Index f) {
  const Eigen::Vector3d a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)),
                        c = mesh.V.row(mesh.F(f, 2));
  return (b - a).cross(c - a).norm();
}

// Leaves out faces without area.
int drop_degenerate(TriangleMesh& mesh) {
  const double least = 1e-14 * std::pow(bounding_box(mesh.V).diagonal(), 2);
  Eigen::Index kept = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    if (doubled_area(mesh, f) > least) mesh.F.row(kept++) = mesh.F.row(f).eval();
  }
  const auto dropped = static_cast<int>(mesh.F.rows() - kept);
  mesh.F.conservativeResize(kept, 3);
  return dropped;
}

// Turns faces until neighbours agree, each part after its first face. Returns the number of turned faces.
int orient(TriangleMesh& mesh) {
  std::map<std::pair<int, int>, std::vector<int>> faces_at;
  for (int f = 0; f < mesh.F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) faces_at[std::minmax(mesh.F(f, k), mesh.F(f, (k + 1) % 3))].push_back(f);
  }
  for (const auto& [edge, faces] : faces_at) {
    if (faces.size() <= 2) continue;
    throw Error(ErrorKind::geometry,
                "the surface is not a shell: " + std::to_string(faces.size()) +
                    " faces meet at the edge from " + place(mesh, edge.first) + " to " +
                    place(mesh, edge.second),
                "take faces away until at most two meet at every edge");
  }
  const auto runs_along = [&](int f, int a, int b) {
    for (int k = 0; k < 3; ++k) {
      if (mesh.F(f, k) == a && mesh.F(f, (k + 1) % 3) == b) return true;
    }
    return false;
  };
  std::vector<char> seen(static_cast<std::size_t>(mesh.F.rows()), 0);
  int turned = 0;
  for (int start = 0; start < mesh.F.rows(); ++start) {
    if (seen[static_cast<std::size_t>(start)] != 0) continue;
    std::vector<int> queue = {start};
    seen[static_cast<std::size_t>(start)] = 1;
    for (std::size_t i = 0; i < queue.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        const int a = mesh.F(queue[i], k), b = mesh.F(queue[i], (k + 1) % 3);
        for (const int other : faces_at.at(std::minmax(a, b))) {
          if (other == queue[i]) continue;
          const bool alike = runs_along(other, b, a);
          if (seen[static_cast<std::size_t>(other)] == 0) {
            seen[static_cast<std::size_t>(other)] = 1;
            if (!alike) {
              std::swap(mesh.F(other, 1), mesh.F(other, 2));
              ++turned;
            }
            queue.push_back(other);
          } else if (!alike) {
            throw Error(ErrorKind::geometry,
                        "the surface is not a shell: it has one side only, like a Moebius strip, seen at the "
                        "edge from " +
                            place(mesh, a) + " to " + place(mesh, b),
                        "cut it open");
          }
        }
      }
    }
  }
  if (is_closed_oriented(mesh.F) && signed_volume(mesh) < 0) mesh.F = mesh.F.rowwise().reverse().eval();
  return turned;
}

void check_fans(const TriangleMesh& mesh) {
  if (is_manifold(mesh.F)) return;
  // The vertex with more than one fan: its faces do not all hang together.
  std::vector<std::vector<int>> faces(static_cast<std::size_t>(mesh.V.rows()));
  for (int f = 0; f < mesh.F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) faces[static_cast<std::size_t>(mesh.F(f, k))].push_back(f);
  }
  for (int v = 0; v < mesh.V.rows(); ++v) {
    const auto& around = faces[static_cast<std::size_t>(v)];
    Triangles fan(std::ssize(around), 3);
    for (std::size_t i = 0; i < around.size(); ++i)
      fan.row(static_cast<Eigen::Index>(i)) = mesh.F.row(around[i]);
    if (is_manifold(fan)) continue;
    throw Error(ErrorKind::geometry,
                "the surface is not a shell: parts of it touch only in the vertex at " + place(mesh, v),
                "move them apart there, or join them by an edge");
  }
}

double min_angle(const TriangleMesh& mesh) {
  double smallest = std::numbers::pi;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d a = mesh.V.row(mesh.F(f, k)),
                            u = mesh.V.row(mesh.F(f, (k + 1) % 3)).transpose() - a,
                            v = mesh.V.row(mesh.F(f, (k + 2) % 3)).transpose() - a;
      smallest = std::min(smallest, std::atan2(u.cross(v).norm(), u.dot(v)));
    }
  }
  return smallest * 180 / std::numbers::pi;
}

// The remeshed surface whose number of vertices is nearest to the wanted one.
TriangleMesh remeshed(const TriangleMesh& surface, int vertices) {
  double area = 0;
  for (Eigen::Index f = 0; f < surface.F.rows(); ++f) area += doubled_area(surface, f) / 2;
  const auto deviation = [&](const TriangleMesh& mesh) {
    return std::abs(static_cast<double>(mesh.V.rows()) / vertices - 1);
  };
  // Equilateral triangles, two for each vertex.
  const double guess = std::log(std::sqrt(2 / std::sqrt(3.0) * area / vertices));
  double small = guess - 1.5, large = guess + 1.5;
  TriangleMesh best;
  for (int step = 0; step < 12; ++step) {
    const double length = step == 0 ? guess : (small + large) / 2;
    TriangleMesh mesh = remesh_shell(surface, std::exp(length));
    (mesh.V.rows() > vertices ? small : large) = length;
    if (best.V.rows() == 0 || deviation(mesh) < deviation(best)) best = std::move(mesh);
    if (deviation(best) <= kEnough) break;
  }
  return best;
}

// Vertices in the order of their coordinates.
void sort_vertices(TriangleMesh& mesh) {
  std::vector<int> order(static_cast<std::size_t>(mesh.V.rows())), row(order.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int v) { return std::array{mesh.V(v, 0), mesh.V(v, 1), mesh.V(v, 2)}; };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < order.size(); ++i)
    row[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
  mesh.V = mesh.V(order, Eigen::all).eval();
  mesh.F = mesh.F.unaryExpr([&](int v) { return row[static_cast<std::size_t>(v)]; }).eval();
}

}  // namespace

ShellMesh shell_mesh(const TriangleMesh& surface, int vertices) {
  if (surface.F.rows() == 0) throw Error(ErrorKind::geometry, "the surface has no face", "give a mesh");
  if (!surface.V.allFinite()) {
    throw Error(ErrorKind::geometry, "the surface has a vertex that is not finite", "repair the mesh");
  }
  ShellMesh shell;
  shell.mesh = without_duplicates(surface);
  const Eigen::Index joined = surface.V.rows() - shell.mesh.V.rows();
  if (joined > 0) shell.notes.push_back("joined " + std::to_string(joined) + " duplicate vertices");
  const int dropped = drop_degenerate(shell.mesh);
  if (dropped > 0) shell.notes.push_back("dropped " + std::to_string(dropped) + " faces without area");
  if (shell.mesh.F.rows() == 0) {
    throw Error(ErrorKind::geometry, "the surface has no face with an area", "repair the mesh");
  }
  const int turned = orient(shell.mesh);
  if (turned > 0) shell.notes.push_back("turned " + std::to_string(turned) + " faces");
  check_fans(shell.mesh);
  drop_unused_vertices(shell.mesh);

  if (vertices > 0 && vertices != shell.mesh.V.rows()) {
    const Bytes bytes =
        run_guarded("remeshing a shell", "ask for another number of vertices, or for 0", {120, 4096}, [&] {
          const TriangleMesh mesh = remeshed(shell.mesh, vertices);
          return ByteWriter().put(mesh.V).put(mesh.F).take();
        });
    const Eigen::Index before = shell.mesh.V.rows();
    ByteReader reader(bytes);
    reader.get(shell.mesh.V);
    reader.get(shell.mesh.F);
    const Eigen::Index reached = shell.mesh.V.rows();
    if (std::abs(static_cast<double>(reached) / vertices - 1) > kCountTolerance ||
        !is_manifold(shell.mesh.F)) {
      throw Error(ErrorKind::geometry,
                  "the shell cannot be meshed with " + std::to_string(vertices) +
                      " vertices; the nearest is " + std::to_string(reached),
                  "ask for more vertices, or simplify its borders and creases");
    }
    sort_vertices(shell.mesh);
    shell.notes.push_back("remeshed from " + std::to_string(before) + " to " + std::to_string(reached) +
                          " vertices");
  }
  shell.min_angle = min_angle(shell.mesh);
  return shell;
}

}  // namespace vivify::meshing
