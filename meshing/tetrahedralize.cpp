#include "meshing/tetrahedralize.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <optional>
#include <utility>

#include "common/error.h"
#include "common/registry.h"
#include "meshing/backends/cgal_mesh3.h"
#include "meshing/backends/tetgen.h"
#include "meshing/byte_stream.h"
#include "meshing/closest_point.h"
#include "meshing/coarsen.h"
#include "meshing/improve.h"
#include "meshing/quality.h"
#include "meshing/wrap.h"

namespace vivify::meshing {
namespace {

constexpr double kCountTolerance = 0.15;
constexpr double kCountAim = 0.03;
constexpr int kCountSteps = 10;
constexpr double kGoodAngle = 10;    // degrees: no further attempt when every dihedral angle is at least this
constexpr double kWorstAngle = 2;    // degrees: an error below
constexpr double kWantedAngle = 18;  // degrees: what improve_tetrahedra works towards
constexpr double kOffsetShare = 0.06;  // offset of the wrap over its alpha
constexpr double kFitDistance = 4;     // vertices within this many offsets go back onto the surface
constexpr double kSurfaceTolerance =
    0.004;  // of the size: how far the boundary may move while shapes are improved

// One attempt: the surface that was filled, and what came out.
struct Filling {
  TetMesh mesh;
  double surface_volume = 0;  // m³, of the surface that the backend filled
  int surface_components = 0;
};

struct Task {
  const TriangleMesh& drawn;
  const ClosestPoint& closest;
  const TetrahedralizeSettings& settings;
  double size;  // diagonal of the drawn surface (m)
};

struct Backend {
  std::string_view name;
  double volume_tolerance;  // of the volume of the surface that was filled
  Filling (*fill)(const Task& task, const TriangleMesh& wrap, double offset);
};

Bytes to_bytes(const TriangleMesh& mesh) { return ByteWriter().put(mesh.V).put(mesh.F).take(); }

template <class Work>
TriangleMesh guarded_surface(const Task& task, const std::string& what, const Work& work) {
  const Bytes bytes = run_guarded(what, "repair the surface or ask for fewer vertices", task.settings.limits,
                                  [&] { return to_bytes(work()); });
  TriangleMesh mesh;
  ByteReader reader(bytes);
  reader.get(mesh.V);
  reader.get(mesh.F);
  return mesh;
}

double mean_edge(const TriangleMesh& mesh) {
  double sum = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) sum += (mesh.V.row(mesh.F(f, k)) - mesh.V.row(mesh.F(f, (k + 1) % 3))).norm();
  }
  return sum / (3.0 * static_cast<double>(mesh.F.rows()));
}

// The wrap stands off the surface by its offset; its vertices go back, but for those that close a gap.
TriangleMesh fitted(TriangleMesh mesh, const ClosestPoint& closest, double offset, double share) {
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
    const ClosestPoint::Hit hit = closest(mesh.V.row(v));
    if (hit.distance < kFitDistance * offset)
      mesh.V.row(v) += share * (hit.point.transpose() - mesh.V.row(v));
  }
  return mesh;
}

// The wrap with `count` vertices, on the drawn surface as far as it then does not intersect itself.
TriangleMesh coarse_surface(const Task& task, const TriangleMesh& wrap, int count, double offset) {
  return guarded_surface(task, "coarsening the surface", [&] {
    const TriangleMesh coarse = collapse_surface(wrap, count);
    for (const double share : {1.0, 0.75, 0.5, 0.0}) {
      TriangleMesh mesh = fitted(coarse, task.closest, offset, share);
      if (!intersects_itself(mesh) && signed_volume(mesh) > 0) return mesh;
    }
    throw Error(ErrorKind::geometry, "the coarsened surface intersects itself");
  });
}

int vertex_count(const Filling& filling) { return static_cast<int>(filling.mesh.V.rows()); }

double count_error(const Filling& filling, int wanted) {
  return std::abs(static_cast<double>(vertex_count(filling)) / wanted - 1);
}

// Calls make(parameter) with parameter ← next(parameter, wanted / count), and gives back the filling whose
// count is nearest. Attempts that fail with Error(geometry) are passed over; when all do, the last one is
// thrown.
template <class Make, class Next>
Filling search_count(int wanted, double parameter, const Make& make, const Next& next) {
  std::optional<Filling> best;
  std::optional<Error> failure;
  for (int step = 0; step < kCountSteps; ++step) {
    double ratio = 1.06;  // after a failure: a little finer
    try {
      Filling filling = make(parameter);
      ratio = static_cast<double>(wanted) / std::max(1, vertex_count(filling));
      if (!best || count_error(filling, wanted) < count_error(*best, wanted)) best = std::move(filling);
      if (count_error(*best, wanted) <= kCountAim) break;
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::geometry) throw;
      failure = error;
    }
    const double next_parameter = next(parameter, ratio);
    if (next_parameter == parameter) break;
    parameter = next_parameter;
  }
  if (!best) throw *failure;
  return std::move(*best);
}

ImproveSettings improve_settings(const Task& task) {
  ImproveSettings settings;
  settings.wanted_angle = kWantedAngle;
  settings.surface_tolerance = kSurfaceTolerance * task.size;
  return settings;
}

Filling fill_with_tetgen(const Task& task, const TriangleMesh& wrap, double offset) {
  const auto most = static_cast<double>(wrap.V.rows());
  const auto make = [&](double count) {
    const TriangleMesh surface = coarse_surface(task, wrap, static_cast<int>(std::lround(count)), offset);
    const double edge = mean_edge(surface) / bounding_box(surface.V).diagonal();
    std::array<char, 64> switches = {};
    std::snprintf(switches.data(), switches.size(), "pYq1.414/10a%.12f", 0.3 * edge * edge * edge);
    Filling filling;
    filling.mesh = run_tetgen({surface.V, surface.F}, switches.data(), task.settings.limits).mesh;
    filling.surface_volume = signed_volume(surface);
    filling.surface_components = component_count(surface.F);
    drop_unused_vertices(filling.mesh);
    return filling;
  };
  const auto next = [&](double count, double ratio) {
    return std::clamp(std::round(count * std::pow(ratio, 0.85)), 6.0, most);
  };
  return search_count(task.settings.vertices, std::min<double>(task.settings.vertices, most), make, next);
}

Filling fill_with_cgal(const Task& task, const TriangleMesh& wrap, double offset) {
  const TriangleMesh surface = guarded_surface(task, "fitting the surface", [&] {
    for (const double share : {1.0, 0.5}) {
      TriangleMesh mesh = fitted(wrap, task.closest, offset, share);
      if (!intersects_itself(mesh)) return mesh;
    }
    return wrap;
  });
  const double volume = signed_volume(surface);
  const auto make = [&](double size) {
    const Bytes bytes =
        run_guarded("meshing with CGAL", "choose the backend tetgen", task.settings.limits, [&] {
          const TetMesh mesh = mesh_with_cgal(surface, size);
          return ByteWriter().put(mesh.V).put(mesh.T).take();
        });
    Filling filling;
    ByteReader reader(bytes);
    reader.get(filling.mesh.V);
    reader.get(filling.mesh.T);
    filling.surface_volume = volume;
    filling.surface_components = component_count(surface.F);
    return filling;
  };
  const auto next = [&](double size, double ratio) {
    return size * std::pow(std::clamp(ratio, 0.1, 10.0), -1.0 / 2.5);
  };
  return search_count(task.settings.vertices, 1.5 * std::cbrt(volume / task.settings.vertices), make, next);
}

constexpr std::array<Backend, 2> kBackends = {{
    {"tetgen", 0.02, fill_with_tetgen},
    {"cgal", 0.10, fill_with_cgal},
}};

std::string rounded(double value, int digits) {
  std::array<char, 64> text = {};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return text.data();
}

// Why the filling may not be used; empty when it may.
std::string find_fault(const Filling& filling, const Backend& backend, int wanted) {
  const TetMesh& mesh = filling.mesh;
  if (mesh.T.rows() == 0) return "no tetrahedron was made";
  const double ratio = tet_volumes(mesh).sum() / filling.surface_volume;
  if (std::abs(ratio - 1) > backend.volume_tolerance) {
    return "the tetrahedra fill " + rounded(100 * ratio, 1) + " % of the volume";
  }
  if (component_count(mesh.T) != filling.surface_components) {
    return "the tetrahedra have " + std::to_string(component_count(mesh.T)) +
           " parts where the surface has " + std::to_string(filling.surface_components);
  }
  if (count_error(filling, wanted) > kCountTolerance) {
    return std::to_string(vertex_count(filling)) + " vertices came out where " + std::to_string(wanted) +
           " are wanted";
  }
  return {};
}

// The same for the mesh after its improvement.
std::string find_shape_fault(const TetMesh& mesh) {
  if (!(tet_volumes(mesh).minCoeff() > 0)) return "a tetrahedron is turned inside out";
  const Triangles boundary = boundary_faces(mesh);
  if (!is_closed_oriented(boundary) || !is_manifold(boundary))
    return "the boundary of the tetrahedra is not manifold";
  const double angle = dihedral_range(mesh).min;
  if (angle < kWorstAngle) return "the smallest dihedral angle is " + rounded(angle, 1) + " degrees";
  return {};
}

// Vertices by coordinates, tetrahedra by their vertices: the order does not depend on the backend.
void sort_mesh(TetMesh& mesh) {
  std::vector<int> order(static_cast<std::size_t>(mesh.V.rows()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return std::lexicographical_compare(mesh.V.row(a).begin(), mesh.V.row(a).end(), mesh.V.row(b).begin(),
                                        mesh.V.row(b).end());
  });
  std::vector<int> place(order.size());
  Points V(mesh.V.rows(), 3);
  for (std::size_t i = 0; i < order.size(); ++i) {
    place[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
    V.row(static_cast<Eigen::Index>(i)) = mesh.V.row(order[i]);
  }
  mesh.V = V;
  std::vector<std::array<int, 4>> tets;
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t) {
    std::array<int, 4> tet = {};
    for (int k = 0; k < 4; ++k)
      tet[static_cast<std::size_t>(k)] = place[static_cast<std::size_t>(mesh.T(t, k))];
    int swaps = 0;  // sort by swaps, then restore the orientation
    for (std::size_t i = 0; i < 4; ++i) {
      const auto least = static_cast<std::size_t>(
          std::min_element(tet.begin() + static_cast<long>(i), tet.end()) - tet.begin());
      if (least != i) {
        std::swap(tet[i], tet[least]);
        ++swaps;
      }
    }
    if (swaps % 2 != 0) std::swap(tet[2], tet[3]);
    tets.push_back(tet);
  }
  std::sort(tets.begin(), tets.end());
  for (std::size_t t = 0; t < tets.size(); ++t) {
    mesh.T.row(static_cast<Eigen::Index>(t)) << tets[t][0], tets[t][1], tets[t][2], tets[t][3];
  }
}

std::optional<TetMesh> improved(const Task& task, const TetMesh& mesh, std::string& fault) {
  TetMesh better = mesh;
  improve_tetrahedra(better, task.closest, improve_settings(task));
  drop_unused_vertices(better);
  fault = find_shape_fault(better);
  if (fault.empty()) return better;
  const std::string fault_before = find_shape_fault(mesh);
  if (fault_before.empty()) return mesh;
  return std::nullopt;
}

void add_notes(const Task& task, double alpha, TetrahedralizeResult& result) {
  const auto note = [&](const std::string& text) { result.notes.push_back(text); };
  note("closed gaps and holes narrower than " + rounded(100 * alpha / task.size, 1) + " % of the size");
  const Triangles boundary = boundary_faces(result.mesh);
  const int parts = component_count(task.drawn.F);
  if (result.components < parts) {
    note("the " + std::to_string(parts) + " parts of the surface became " +
         std::to_string(result.components));
  }
  const int handles = parts - euler_characteristic(task.drawn.F) / 2;
  const int kept = result.components - euler_characteristic(boundary) / 2;
  if (kept < handles)
    note("closed " + std::to_string(handles - kept) + " of " + std::to_string(handles) +
         " holes (as through a handle)");
  if (result.min_dihedral < kGoodAngle) {
    note("the smallest dihedral angle is " + rounded(result.min_dihedral, 1) +
         " degrees: another number of vertices may do better");
  }
}

void check_surface(const TriangleMesh& surface) {
  if (surface.F.rows() == 0 || !is_closed_oriented(surface.F) || !(signed_volume(surface) > 0)) {
    throw Error(ErrorKind::geometry, "the surface to be filled with tetrahedra is not closed and outward",
                "repair it first");
  }
}

}  // namespace

TetrahedralizeResult tetrahedralize(const TriangleMesh& closed_surface,
                                    const TetrahedralizeSettings& settings) {
  check_surface(closed_surface);
  const Backend& backend =
      find_entry(std::span<const Backend>(kBackends), settings.backend, "tetrahedra backend");
  const ClosestPoint closest(closed_surface);
  const Task task = {closed_surface, closest, settings, bounding_box(closed_surface.V).diagonal()};
  const double usual_alpha = task.size / std::clamp(2.4 * std::sqrt(settings.vertices), 10.0, 120.0);
  const double first_alpha = settings.gap > 0 ? settings.gap * task.size : usual_alpha;

  TetrahedralizeResult result;
  double result_alpha = 0;
  std::string fault;
  for (const double factor : {1.0, 1.4, 0.7, 2.0, 0.5, 3.0}) {
    if (settings.gap > 0 && factor > 1) continue;  // what was to stay open stays open
    const double alpha = factor * first_alpha, offset = kOffsetShare * alpha;
    try {
      const TriangleMesh wrap = guarded_surface(task, "wrapping the surface",
                                                [&] { return wrap_surface(closed_surface, alpha, offset); });
      Filling filling = backend.fill(task, wrap, offset);
      fault = find_fault(filling, backend, settings.vertices);
      if (!fault.empty()) continue;
      std::optional<TetMesh> mesh = improved(task, filling.mesh, fault);
      if (!mesh) continue;
      const AngleRange angles = dihedral_range(*mesh);
      if (angles.min <= result.min_dihedral) continue;
      result.mesh = std::move(*mesh);
      result.min_dihedral = angles.min;
      result.max_dihedral = angles.max;
      result_alpha = alpha;
      if (angles.min >= kGoodAngle) break;
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::geometry) throw;
      fault = error.what();
    }
  }
  if (result.mesh.T.rows() == 0) {
    throw Error(ErrorKind::geometry,
                "no tetrahedra with about " + std::to_string(settings.vertices) + " vertices: " + fault,
                settings.backend == "cgal" ? "choose the backend tetgen, or more vertices"
                                           : "ask for another number of vertices");
  }
  sort_mesh(result.mesh);
  result.components = component_count(result.mesh.T);
  result.volume_ratio = tet_volumes(result.mesh).sum() / signed_volume(closed_surface);
  add_notes(task, result_alpha, result);
  return result;
}

Schema tetrahedra_schema() {
  std::vector<std::string> names;
  for (const Backend& backend : kBackends) names.emplace_back(backend.name);
  return object("The tetrahedra that move the body; the detailed surface is carried along.")
      .field("backend",
             choice("The program that makes the tetrahedra: tetgen follows the surface exactly, cgal only "
                    "approximately.",
                    names)
                 .initially("tetgen"))
      .field("vertices", integer("Wanted number of vertices; the mesh has this many within 15 %.")
                             .at_least(20)
                             .at_most(50000)
                             .initially(100))
      .field("gap", number("Gaps and holes narrower than this part of the body's size (its diagonal) are "
                           "closed. 0: a size "
                           "that suits the number of vertices.")
                        .at_least(0)
                        .at_most(0.5)
                        .initially(0.0))
      .field("time_limit_s",
             number("Time that one step of the meshing may take.").unit("s").above(0).initially(60.0))
      .field("memory_limit_mb",
             number("Memory that one step of the meshing may take.").unit("MB").above(0).initially(6000.0));
}

TetrahedralizeSettings tetrahedra_settings(const Value& value) {
  TetrahedralizeSettings settings;
  settings.backend = value["backend"].as_string();
  settings.vertices = static_cast<int>(value["vertices"].as_integer());
  settings.gap = value["gap"].as_number();
  settings.limits = {value["time_limit_s"].as_number(), value["memory_limit_mb"].as_number()};
  return settings;
}

}  // namespace vivify::meshing
