#include "meshing/repair_steps.h"

#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>

#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "common/error.h"
#include "common/text.h"
#include "meshing/byte_stream.h"
#include "meshing/cgal_convert.h"
#include "meshing/wrap.h"

namespace vivify::meshing {
namespace {

namespace PMP = CGAL::Polygon_mesh_processing;

constexpr double kWrapAlpha = 0.025;    // of the diagonal
constexpr double kWrapOffset = 0.0006;  // of the diagonal
constexpr double kHollowVolume = 0.6;   // a wrap with less than this share of the filled volume is a shell
constexpr double kNoVolume = 1e-9;      // of the cubed diagonal

using Polygon = std::vector<std::size_t>;

struct Soup {
  std::vector<Point> points;
  std::vector<Polygon> polygons;
};

std::string counted(std::size_t count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

class Repair {
 public:
  explicit Repair(const TriangleMesh& input)
      : input_(input), diagonal_(bounding_box(used_points(input)).diagonal()) {}

  Bytes step_by_step() {
    join_and_clean();
    orient();
    make_surface();
    remove_degenerate_faces();
    fill_holes();
    const std::string obstacle = find_obstacle();
    if (obstacle.empty()) return finish(from_surface_mesh(surface_), changed_ ? "repaired" : "kept");
    return wrap(obstacle);
  }

  Bytes wrap_input() {
    return finish(wrap_surface(input_, kWrapAlpha * diagonal_, kWrapOffset * diagonal_), "wrapped");
  }

 private:
  static Points used_points(const TriangleMesh& mesh) {
    Points used(mesh.F.size(), 3);
    for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
      for (int k = 0; k < 3; ++k) used.row(3 * f + k) = mesh.V.row(mesh.F(f, k));
    }
    return used;
  }

  void note(const std::string& text, bool is_change = true) {
    notes_.push_back(text);
    changed_ = changed_ || is_change;
  }

  // Joins vertices at the same place; drops triangles of zero area and all but one of equal triangles.
  void join_and_clean() {
    std::map<std::array<double, 3>, std::size_t> places;
    std::vector<std::size_t> place(static_cast<std::size_t>(input_.V.rows()), 0);
    std::set<Eigen::Index> used;
    for (Eigen::Index f = 0; f < input_.F.rows(); ++f) {
      for (int k = 0; k < 3; ++k) used.insert(input_.F(f, k));
    }
    for (const Eigen::Index v : used) {
      const auto x = input_.V.row(v);
      const auto [it, is_new] = places.try_emplace({x[0] + 0.0, x[1] + 0.0, x[2] + 0.0}, soup_.points.size());
      if (is_new) soup_.points.emplace_back(x[0], x[1], x[2]);
      place[static_cast<std::size_t>(v)] = it->second;
    }
    std::set<Polygon> seen;
    std::size_t flat = 0, doubled = 0;
    for (Eigen::Index f = 0; f < input_.F.rows(); ++f) {
      Polygon polygon;
      for (int k = 0; k < 3; ++k) polygon.push_back(place[static_cast<std::size_t>(input_.F(f, k))]);
      Polygon key = polygon;
      std::sort(key.begin(), key.end());
      if (key[0] == key[1] || key[1] == key[2]) {
        ++flat;
      } else if (!seen.insert(key).second) {
        ++doubled;
      } else {
        soup_.polygons.push_back(polygon);
      }
    }
    if (used.size() > soup_.points.size()) {
      note("joined " + counted(used.size() - soup_.points.size(), "duplicate vertex", "duplicate vertices"),
           false);
    }
    if (flat > 0) note("dropped " + counted(flat, "degenerate triangle", "degenerate triangles"));
    if (doubled > 0) note("dropped " + counted(doubled, "duplicate triangle", "duplicate triangles"));
    PMP::repair_polygon_soup(soup_.points, soup_.polygons);
  }

  void orient() {
    const std::size_t points_before = soup_.points.size();
    const std::vector<Polygon> before = soup_.polygons;
    PMP::orient_polygon_soup(soup_.points, soup_.polygons);
    if (soup_.points.size() > points_before) {
      note("split " + counted(soup_.points.size() - points_before, "vertex", "vertices") +
           " where more than two triangles share an edge or parts touch in a point");
    }
    std::map<Point, std::size_t> first;
    for (std::size_t v = 0; v < soup_.points.size(); ++v) first.try_emplace(soup_.points[v], v);
    for (std::size_t f = 0; f < before.size(); ++f) {
      Polygon now;
      for (const std::size_t v : soup_.polygons[f]) now.push_back(first[soup_.points[v]]);
      const auto corner = std::find(now.begin(), now.end(), before[f][0]);
      std::rotate(now.begin(), corner, now.end());
      if (now[1] != before[f][1]) ++flipped_;
    }
  }

  void make_surface() {
    if (!PMP::is_polygon_soup_a_polygon_mesh(soup_.polygons)) {
      throw Error(ErrorKind::geometry, "the triangles do not form a surface");
    }
    PMP::polygon_soup_to_polygon_mesh(soup_.points, soup_.polygons, surface_);
    const std::size_t stitched = PMP::stitch_borders(surface_);
    if (stitched > 0) note("stitched " + counted(stitched, "pair of edges", "pairs of edges"));
  }

  void remove_degenerate_faces() {
    const std::size_t before = surface_.number_of_faces();
    PMP::remove_degenerate_faces(surface_);
    surface_.collect_garbage();
    const std::size_t after = surface_.number_of_faces();
    if (before != after) {
      note("removed " + counted(before > after ? before - after : after - before, "degenerate triangle",
                                "degenerate triangles"));
    }
  }

  void fill_holes() {
    std::vector<SurfaceMesh::Halfedge_index> holes;
    PMP::extract_boundary_cycles(surface_, std::back_inserter(holes));
    std::size_t filled = 0, patch_triangles = 0;
    for (const auto hole : holes) {
      std::vector<SurfaceMesh::Face_index> patch;
      PMP::triangulate_hole(surface_, hole, std::back_inserter(patch));
      if (!patch.empty()) ++filled;
      patch_triangles += patch.size();
    }
    if (filled > 0) {
      note("filled " + counted(filled, "hole", "holes") + " with " +
           counted(patch_triangles, "triangle", "triangles"));
    }
    open_holes_ = holes.size() - filled;
  }

  // Why the surface cannot stay as it is; empty when it can.
  std::string find_obstacle() {
    if (surface_.number_of_faces() == 0) return "no triangle was left";
    if (!CGAL::is_closed(surface_)) {
      return counted(open_holes_, "hole", "holes") + " could not be filled";
    }
    std::vector<std::pair<SurfaceMesh::Face_index, SurfaceMesh::Face_index>> pairs;
    PMP::self_intersections(surface_, std::back_inserter(pairs));
    if (!pairs.empty()) {
      std::set<SurfaceMesh::Face_index> faces;
      for (const auto& [a, b] : pairs) faces.insert({a, b});
      return counted(faces.size(), "triangle intersects", "triangles intersect") + " one another";
    }
    const double before = enclosed_volume();
    PMP::orient_to_bound_a_volume(surface_);
    const double volume = enclosed_volume();
    if (!(volume > kNoVolume * std::pow(diagonal_, 3))) return "the surface encloses no volume";
    note_orientation(before < 0);
    note_cavities(before);
    return {};
  }

  double enclosed_volume() const { return signed_volume(from_surface_mesh(surface_)); }

  void note_orientation(bool reversed) {
    if (reversed) flipped_ = soup_.polygons.size() - flipped_;
    if (flipped_ == soup_.polygons.size()) {
      note("turned the surface inside out: it was oriented inward");
    } else if (flipped_ > 0) {
      note("turned round " + counted(flipped_, "triangle", "triangles"));
    }
  }

  void note_cavities(double volume_before) {
    const auto part = surface_.add_property_map<SurfaceMesh::Face_index, std::size_t>("f:part", 0).first;
    const std::size_t parts = PMP::connected_components(surface_, part);
    if (parts < 2) return;
    std::vector<double> volumes(parts, 0);
    const Point origin = surface_.point(*surface_.vertices().begin());
    for (const auto face : surface_.faces()) {
      const auto h = surface_.halfedge(face);
      const Point &a = surface_.point(surface_.source(h)), &b = surface_.point(surface_.target(h)),
                  &c = surface_.point(surface_.target(surface_.next(h)));
      volumes[part[face]] += CGAL::to_double(CGAL::volume(origin, a, b, c));
    }
    const auto cavities = static_cast<std::size_t>(
        std::count_if(volumes.begin(), volumes.end(), [](double v) { return v < 0; }));
    if (parts - cavities > 1) {
      note("the surface has " + std::to_string(parts - cavities) + " separate parts", false);
    }
    if (cavities > 0) {
      note("the surface has " + counted(cavities, "hidden cavity", "hidden cavities") + " inside", false);
      const double after = enclosed_volume();
      if (std::abs(after - std::abs(volume_before)) > 1e-6 * after) {
        note("an inner shell was oriented as a part of its own and now is the wall of a cavity");
      }
    }
  }

  Bytes wrap(const std::string& obstacle) {
    const bool closed = CGAL::is_closed(surface_);
    const double filled_volume = closed ? std::abs(enclosed_volume()) : 0;
    TriangleMesh soup = from_surface_mesh(surface_);
    if (soup.F.rows() == 0) soup = input_;
    TriangleMesh mesh = wrap_surface(soup, kWrapAlpha * diagonal_, kWrapOffset * diagonal_);
    notes_.push_back("wrapped because " + obstacle + ": details below " + number_text(100 * kWrapAlpha) +
                     " % of the size are lost, and the surface lies " + number_text(100 * kWrapOffset) +
                     " % of it outside");
    if (filled_volume > 0 && signed_volume(mesh) < kHollowVolume * filled_volume) {
      notes_.push_back("the wrap may be a hollow shell: it encloses " +
                       number_text(std::round(1000 * signed_volume(mesh) / filled_volume) / 10) +
                       " % of the volume of the mesh with its holes filled");
    }
    return finish(std::move(mesh), "wrapped");
  }

  Bytes finish(TriangleMesh mesh, const std::string& route) {
    if (mesh.F.rows() == 0) throw Error(ErrorKind::geometry, "nothing was left of the mesh after its repair");
    if (route == "wrapped") {
      const SurfaceMesh result = to_surface_mesh(mesh);
      if (!CGAL::is_closed(result) || PMP::does_self_intersect(result) || !(signed_volume(mesh) > 0)) {
        throw Error(ErrorKind::geometry, "the wrap of the mesh is not a closed surface", "simplify the mesh");
      }
      const double thickness = 2 * signed_volume(mesh) / area(mesh);
      if (thickness < 4 * kWrapOffset * diagonal_) {
        notes_.push_back("the mesh is a thin sheet: it became a solid about " + number_text(thickness) +
                         " m thick");
      }
    }
    return ByteWriter().put(mesh.V).put(mesh.F).put(route).put(notes_).take();
  }

  static double area(const TriangleMesh& mesh) { return PMP::area(to_surface_mesh(mesh)); }

  const TriangleMesh& input_;
  double diagonal_;
  Soup soup_;
  SurfaceMesh surface_;
  std::vector<std::string> notes_;
  std::size_t open_holes_ = 0;
  std::size_t flipped_ = 0;  // triangles that orient() turned round
  bool changed_ = false;
};

}  // namespace

Bytes repair_step_by_step(const TriangleMesh& input) { return Repair(input).step_by_step(); }

Bytes wrap_as_it_is(const TriangleMesh& input) { return Repair(input).wrap_input(); }

}  // namespace vivify::meshing
