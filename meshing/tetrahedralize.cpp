#include "meshing/tetrahedralize.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
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
constexpr double kGoodVolume = 0.1;  // and when the volume differs from the drawn one by at most this share
constexpr double kGoodFloor = 0.5;   // and when at most this share of the flat face to stand on is lost
constexpr double kWorstAngle = 2;    // degrees: an error below
constexpr double kWantedAngle = 18;  // degrees: what improve_tetrahedra works towards
constexpr double kOffsetShare = 0.06;      // offset of the wrap over its alpha
constexpr double kFitDistance = 4;         // vertices within this many offsets go back onto the surface
constexpr double kCollapseShare = 0.6;     // vertices before even remeshing over vertices after it
constexpr int kEnough = 200;               // vertices of the surface to start from, over the wanted ones
constexpr double kTetVolume = 0.3;         // largest tetrahedron, of the cubed mean edge of the surface
constexpr double kAfterFailure = 0.96;     // edge length after a failed attempt, of that attempt
constexpr double kUnchangedVolume = 0.03;  // a wrap that changes the volume by less closed nothing
constexpr double kFloorThickness = 0.002;  // of the size: what counts as flat
constexpr double kFloorShare = 0.003;      // of the area: smallest flat face to stand on
constexpr double kFloorReach = 0.2;        // of the mean edge: vertices this near to the floor go down to it
constexpr double kSurfaceTolerance =
    0.004;  // of the size: how far the boundary may move while shapes are improved

// The surface that a backend filled, and what came out.
struct Filling {
  TetMesh mesh;
  double surface_volume = 0;  // m³
  int surface_components = 0;
};

// A surface to be coarsened: the drawn one itself (offset 0), or a wrap of it that has no gaps and holes
// below alpha.
struct Base {
  TriangleMesh surface;
  double alpha = 0;
  double offset = 0;
};

// Edges of even length suit the simulation; where they lead to nothing, edges that follow the curvature often
// do.
enum class Spread { even, by_curvature };

struct Task {
  const TriangleMesh& drawn;
  const ClosestPoint& closest;
  const TetrahedralizeSettings& settings;
  double size;        // diagonal of the drawn surface (m)
  double floor;       // its smallest height (m)
  double floor_area;  // of the flat face that it stands on (m²), 0 without one
};

struct Backend {
  std::string_view name;
  double volume_tolerance;  // of the volume of the surface that was filled
  Filling (*fill)(const Task& task, const Base& base, Spread spread);
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

double area(const TriangleMesh& mesh) {
  double sum = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Eigen::RowVector3d a = mesh.V.row(mesh.F(f, 0));
    sum += 0.5 * (mesh.V.row(mesh.F(f, 1)) - a).cross(mesh.V.row(mesh.F(f, 2)) - a).norm();
  }
  return sum;
}

// Area of the triangles that lie within `thickness` of the height `floor` (m²).
double area_on_floor(const TriangleMesh& mesh, double floor, double thickness) {
  double sum = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Eigen::RowVector3d a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)),
                             c = mesh.V.row(mesh.F(f, 2));
    if (std::max({a.y(), b.y(), c.y()}) <= floor + thickness) sum += 0.5 * (b - a).cross(c - a).norm();
  }
  return sum;
}

// A wrap stands off the surface by its offset; its vertices go back, but for those that close a gap. Vertices
// just above the floor go down to it.
TriangleMesh fitted(const Task& task, TriangleMesh mesh, double offset, double share, bool to_floor) {
  const double reach = offset > 0 ? kFitDistance * offset : task.size;
  to_floor = to_floor && task.floor_area > 0;
  const double floor_reach = kFloorReach * mean_edge(mesh);
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
    const ClosestPoint::Hit hit = task.closest(mesh.V.row(v));
    if (hit.distance < reach) mesh.V.row(v) += share * (hit.point.transpose() - mesh.V.row(v));
    if (to_floor && mesh.V(v, 1) < task.floor + floor_reach) mesh.V(v, 1) = task.floor;
  }
  return mesh;
}

// Vertices of a surface of this area with triangles of this edge length.
double expected_vertices(double surface_area, double edge) {
  return 2 / std::sqrt(3.0) * surface_area / (edge * edge);
}

// The base with triangles of about this edge length, on the drawn surface as far as it then does not
// intersect itself.
TriangleMesh coarse_surface(const Task& task, const Base& base, Spread spread, double edge) {
  return guarded_surface(task, "coarsening the surface", [&] {
    const double count = expected_vertices(area(base.surface), edge);
    const double share = spread == Spread::even ? kCollapseShare : 1;
    const auto collapsed = static_cast<int>(std::clamp(share * count, 6.0, 1e6));
    TriangleMesh coarse = collapse_surface(base.surface, collapsed);
    if (spread == Spread::even) coarse = remesh_surface(coarse, edge);
    for (const bool to_floor : {true, false}) {
      for (const double fit : {1.0, 0.75, 0.5, 0.0}) {
        TriangleMesh mesh = fitted(task, coarse, base.offset, fit, to_floor);
        if (!intersects_itself(mesh) && signed_volume(mesh) > 0) return mesh;
      }
    }
    throw Error(ErrorKind::geometry, "the coarsened surface intersects itself");
  });
}

int vertex_count(const Filling& filling) { return static_cast<int>(filling.mesh.V.rows()); }

double count_error(const Filling& filling, int wanted) {
  return std::abs(static_cast<double>(vertex_count(filling)) / wanted - 1);
}

// Calls make(edge length) until the number of vertices is near `wanted`, and gives back the filling that came
// nearest. Lengths that fail with Error(geometry) are passed over; when all do, the last error is thrown.
template <class Make>
Filling search_count(int wanted, double edge, const Make& make) {
  std::optional<Filling> best;
  std::optional<Error> failure;
  double too_long = std::numeric_limits<double>::infinity(),
         too_short = 0;  // edge lengths with too few, too many vertices
  for (int step = 0; step < kCountSteps; ++step) {
    double factor = kAfterFailure;
    try {
      Filling filling = make(edge);
      const double ratio = static_cast<double>(std::max(1, vertex_count(filling))) / wanted;
      if (!best || count_error(filling, wanted) < count_error(*best, wanted)) best = std::move(filling);
      if (count_error(*best, wanted) <= kCountAim) break;
      (ratio < 1 ? too_long : too_short) = edge;
      factor = std::pow(std::clamp(ratio, 0.1, 10.0), 1 / 2.4);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::geometry) throw;
      failure = error;
    }
    edge *= factor;
    if (too_short < too_long && (edge <= too_short || edge >= too_long)) {
      edge = std::isfinite(too_long) && too_short > 0 ? std::sqrt(too_short * too_long) : edge;
    }
  }
  if (!best) throw *failure;
  return std::move(*best);
}

ImproveSettings improve_settings(const Task& task) {
  ImproveSettings settings;
  settings.wanted_angle = kWantedAngle;
  settings.surface_tolerance = kSurfaceTolerance * task.size;
  settings.keep_floor = task.floor_area > 0;
  return settings;
}

Filling fill_with_tetgen(const Task& task, const Base& base, Spread spread) {
  const auto make = [&](double edge) {
    const TriangleMesh surface = coarse_surface(task, base, spread, edge);
    const double relative_edge = mean_edge(surface) / bounding_box(surface.V).diagonal();
    std::array<char, 64> switches = {};
    std::snprintf(switches.data(), switches.size(), "pYq1.414/10a%.12f",
                  kTetVolume * std::pow(relative_edge, 3));
    Filling filling;
    filling.mesh = run_tetgen({surface.V, surface.F}, switches.data(), task.settings.limits).mesh;
    filling.surface_volume = signed_volume(surface);
    filling.surface_components = component_count(surface.F);
    drop_unused_vertices(filling.mesh);
    return filling;
  };
  const double first = std::sqrt(2 / std::sqrt(3.0) * area(base.surface) / task.settings.vertices);
  return search_count(task.settings.vertices, first, make);
}

Filling fill_with_cgal(const Task& task, const Base& base, Spread) {
  const TriangleMesh surface = guarded_surface(task, "fitting the surface", [&] {
    for (const double fit : {1.0, 0.5}) {
      TriangleMesh mesh = fitted(task, base.surface, base.offset, fit, true);
      if (!intersects_itself(mesh)) return mesh;
    }
    return base.surface;
  });
  const double volume = signed_volume(surface);
  const auto make = [&](double edge) {
    const Bytes bytes =
        run_guarded("meshing with CGAL", "choose the backend tetgen", task.settings.limits, [&] {
          const TetMesh mesh = mesh_with_cgal(surface, edge);
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
  return search_count(task.settings.vertices, 1.5 * std::cbrt(volume / task.settings.vertices), make);
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

// Which share of the flat face that the drawn surface stands on the mesh does not stand on.
double lost_floor_share(const Task& task, const TetMesh& mesh) {
  if (!(task.floor_area > 0)) return 0;
  const double kept = area_on_floor({mesh.V, boundary_faces(mesh), {}, {}, {}}, task.floor, 1e-9 * task.size);
  return std::max(0.0, 1 - kept / task.floor_area);
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

// The surfaces to try for one size of the gaps to be closed: the drawn one itself when it has no such gaps,
// else a wrap.
std::vector<Base> bases(const Task& task, double factor) {
  const double usual = 1 / std::clamp(2.4 * std::sqrt(task.settings.vertices), 10.0, 60.0);
  const bool given = task.settings.gap > 0;
  if (given && factor > 1) return {};  // what is to stay open stays open
  Base wrap;
  wrap.alpha = factor * task.size * (given ? task.settings.gap : usual);
  wrap.offset = kOffsetShare * wrap.alpha;
  wrap.surface = guarded_surface(task, "wrapping the surface",
                                 [&] { return wrap_surface(task.drawn, wrap.alpha, wrap.offset); });
  const double volume = signed_volume(task.drawn);
  const double wrap_volume = signed_volume(wrap.surface) - wrap.offset * area(task.drawn);
  const bool same = std::abs(wrap_volume / volume - 1) < kUnchangedVolume &&
                    euler_characteristic(wrap.surface.F) == euler_characteristic(task.drawn.F) &&
                    component_count(wrap.surface.F) == component_count(task.drawn.F);
  if (!same || factor != 1) return {wrap};  // for another factor, the drawn surface was tried before
  Base drawn = {task.drawn, 0, 0};
  if (const int enough = kEnough * task.settings.vertices; drawn.surface.V.rows() > 2 * enough) {
    drawn.surface = guarded_surface(task, "simplifying the surface",
                                    [&] { return collapse_surface(task.drawn, enough); });
  }
  return {drawn, wrap};
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
  if (alpha > 0)
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
  const Box box = bounding_box(closed_surface.V);
  const double floor_area = area_on_floor(closed_surface, box.min.y(), kFloorThickness * box.diagonal());
  const bool stands = floor_area > kFloorShare * area(closed_surface);
  const Task task = {closed_surface, closest, settings, box.diagonal(), box.min.y(), stands ? floor_area : 0};

  TetrahedralizeResult result;
  double result_alpha = 0;
  std::string fault;
  double best_score = -std::numeric_limits<double>::infinity();
  const double drawn_volume = signed_volume(closed_surface);
  const auto attempt = [&](const Base& base, Spread spread) {
    bool good = false;
    try {
      Filling filling = backend.fill(task, base, spread);
      fault = find_fault(filling, backend, settings.vertices);
      if (!fault.empty()) return false;
      std::optional<TetMesh> mesh = improved(task, filling.mesh, fault);
      if (!mesh) return false;
      const AngleRange angles = dihedral_range(*mesh);
      const double volume_ratio = tet_volumes(*mesh).sum() / drawn_volume;
      const double lost_floor = lost_floor_share(task, *mesh);
      const double score =
          std::min(angles.min / kGoodAngle, 1.0) - std::abs(volume_ratio - 1) - 0.5 * lost_floor;
      good =
          angles.min >= kGoodAngle && std::abs(volume_ratio - 1) <= kGoodVolume && lost_floor <= kGoodFloor;
      if (good || score > best_score) {
        best_score = score;
        result.volume_ratio = volume_ratio;
        result.mesh = std::move(*mesh);
        result_alpha = base.alpha;
      }
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::geometry) throw;
      fault = error.what();
    }
    return good;
  };
  const auto try_all = [&] {
    for (const double factor : {1.0, 1.4, 0.7, 2.0, 0.5}) {
      for (const Base& base : bases(task, factor)) {
        for (const Spread spread : {Spread::even, Spread::by_curvature}) {
          if (attempt(base, spread)) return;
          if (backend.name == "cgal") break;  // it does not coarsen the surface itself
        }
      }
    }
  };
  try_all();
  if (result.mesh.T.rows() == 0) {
    throw Error(ErrorKind::geometry,
                "no tetrahedra with about " + std::to_string(settings.vertices) + " vertices: " + fault,
                settings.backend == "cgal" ? "choose the backend tetgen, or more vertices"
                                           : "ask for another number of vertices");
  }
  sort_mesh(result.mesh);
  const AngleRange range = dihedral_range(result.mesh);
  result.min_dihedral = range.min;
  result.max_dihedral = range.max;
  result.components = component_count(result.mesh.T);
  const ClosestPoint closest_on_mesh({result.mesh.V, boundary_faces(result.mesh), {}, {}, {}});
  for (Eigen::Index v = 0; v < closed_surface.V.rows(); ++v) {
    result.distance = std::max(result.distance, closest_on_mesh(closed_surface.V.row(v)).distance);
  }
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
