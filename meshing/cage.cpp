#include "meshing/cage.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <vector>

#include "common/error.h"
#include "common/log.h"
#include "common/text.h"
#include "meshing/byte_stream.h"
#include "meshing/collapse.h"
#include "meshing/enclosure.h"
#include "meshing/guarded_process.h"
#include "meshing/surface_checks.h"
#include "meshing/tapered_box.h"
#include "meshing/wrap.h"

namespace vivify::meshing {
namespace {

// Lengths over the diagonal of the character.
constexpr double kCoreAlpha = 1.0 / 40;  // the tight wrap that the cage must not touch
constexpr double kCoreOffset = 1.0 / 400;
constexpr double kStartOffset = 1.0 / 100;  // between the start of the collapse and the tight wrap
// What is narrower than this is filled before the collapse: handles and gaps cost vertices.
constexpr std::array<double, 5> kStartAlphas = {1.0 / 25, 1.0 / 12, 1.0 / 6, 1.0 / 3, 1};

TriangleMesh join(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh mesh;
  mesh.V.resize(a.V.rows() + b.V.rows(), 3);
  mesh.V << a.V, b.V;
  mesh.F.resize(a.F.rows() + b.F.rows(), 3);
  mesh.F << a.F, b.F.array() + static_cast<int>(a.V.rows());
  return mesh;
}

// A cube around each point that holds the ball of the given radius.
TriangleMesh cubes(const Points& points, double radius) {
  static constexpr int kFaces[12][3] = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                                        {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  TriangleMesh mesh;
  mesh.V.resize(8 * points.rows(), 3);
  mesh.F.resize(12 * points.rows(), 3);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    for (int k = 0; k < 8; ++k) {
      const Eigen::RowVector3d corner(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
      mesh.V.row(8 * i + k) = points.row(i) + radius * corner;
    }
    for (int f = 0; f < 12; ++f) {
      for (int k = 0; k < 3; ++k) mesh.F(12 * i + f, k) = static_cast<int>(8 * i) + kFaces[f][k];
    }
  }
  return mesh;
}

// The smallest of the cages that come nearest to the wanted number of vertices, from finer and coarser wraps.
TriangleMesh wrap_and_collapse(const TriangleMesh& enclosed, double diagonal, int vertices) {
  const TriangleMesh core = wrap_surface(enclosed, kCoreAlpha * diagonal, kCoreOffset * diagonal);
  TriangleMesh best;
  for (double alpha : kStartAlphas) {
    TriangleMesh start = wrap_surface(core, alpha * diagonal, kStartOffset * diagonal);
    if (component_count(start) > 1) continue;  // one character, one cage
    for (int finer = 0; finer < 3 && start.V.rows() < vertices && best.V.rows() == 0; ++finer) {
      alpha /= 2;
      start = wrap_surface(core, alpha * diagonal, kStartOffset * diagonal);
    }
    if (start.V.rows() < vertices && best.V.rows() > 0) break;  // the next ones have even fewer
    TriangleMesh cage = collapse_around(start, core, vertices);
    const bool fewer = cage.V.rows() < best.V.rows(), same = cage.V.rows() == best.V.rows();
    if (best.V.rows() == 0 || fewer || (same && signed_volume(cage) < signed_volume(best))) {
      best = std::move(cage);
    }
  }
  return best;
}

TriangleMesh guarded_wrap_and_collapse(const TriangleMesh& enclosed, double diagonal, int vertices) {
  const Bytes bytes =
      run_guarded("making a cage", "give a cage file, or ask for 8 vertices", {300, 4096}, [&] {
        const TriangleMesh cage = wrap_and_collapse(enclosed, diagonal, vertices);
        return ByteWriter().put(cage.V).put(cage.F).take();
      });
  TriangleMesh cage;
  ByteReader reader(bytes);
  reader.get(cage.V);
  reader.get(cage.F);
  return cage;
}

Points join(const Points& a, const Points& b) {
  Points points(a.rows() + b.rows(), 3);
  points << a, b;
  return points;
}

}  // namespace

Schema cage_schema() {
  return object("The rest shape follows a coarse cage around the character, by harmonic coordinates.")
      .field("vertices", integer("Wanted number of cage vertices of an automatic cage; the rest shape has "
                                 "three parameters for each. "
                                 "8 gives a tapered box, other numbers a cage that follows the character.")
                             .at_least(4)
                             .at_most(1000)
                             .initially(8))
      .field("clearance", number("Least distance between an automatic cage and the character, over the "
                                 "diagonal of the character.")
                              .above(0)
                              .at_most(1)
                              .initially(0.02))
      .field("file",
             path("A closed triangle mesh around the character to use as the cage, in the coordinates of the "
                  "character's mesh file. Left out: a cage is made."));
}

CageSettings cage_settings(const Value& value) {
  CageSettings settings;
  settings.vertices = static_cast<int>(value["vertices"].as_integer());
  settings.clearance = value["clearance"].as_number();
  return settings;
}

TriangleMesh make_cage(const Points& must_enclose, const TriangleMesh& surface,
                       const CageSettings& settings) {
  const Points enclosed = join(must_enclose, surface.V);
  const double diagonal = bounding_box(enclosed).diagonal();
  const double clearance = settings.clearance * diagonal;
  TriangleMesh cage;
  if (settings.vertices == 8) {
    cage = tapered_box(enclosed, clearance);
  } else {
    TriangleMesh triangles;
    triangles.V = surface.V;
    triangles.F = surface.F;
    cage = guarded_wrap_and_collapse(join(triangles, cubes(must_enclose, clearance)), diagonal,
                                     settings.vertices);
    if (cage.V.rows() == 0) {
      throw Error(ErrorKind::geometry, "no connected cage could be made around the character",
                  "give a cage file, or ask for 8 vertices");
    }
  }
  cage = validate_cage(std::move(cage), must_enclose, 0.999 * clearance);
  if (cage.V.rows() != settings.vertices) {
    log_warning("the cage has " + std::to_string(cage.V.rows()) + " vertices instead of " +
                std::to_string(settings.vertices) + ": nothing nearer encloses the character");
  }
  log_info("cage: " + std::to_string(cage.V.rows()) + " vertices, " + std::to_string(cage.F.rows()) +
           " triangles, volume " + number_text(signed_volume(cage)) + " m³");
  return cage;
}

TriangleMesh validate_cage(TriangleMesh cage, const Points& must_enclose, double clearance,
                           const std::string& name) {
  const auto fail = [&](const std::string& problem, const std::string& hint) {
    throw Error(ErrorKind::geometry, name + " cannot be used: " + problem, hint);
  };
  if (cage.V.rows() < 4 || cage.F.rows() < 4)
    fail("it has fewer than 4 vertices or faces", "give a closed mesh");
  if (!cage.V.allFinite()) fail("it has a vertex that is not finite", "repair the mesh");
  if (cage.F.minCoeff() < 0 || cage.F.maxCoeff() >= cage.V.rows()) {
    fail("a face refers to a vertex that does not exist", "repair the mesh");
  }
  cage = without_duplicates(cage);
  const std::string topology = topology_problem(cage);
  if (!topology.empty()) fail(topology, "close it and orient its faces alike");
  const auto crossings = self_intersections(cage);
  if (!crossings.empty()) {
    fail("it intersects itself in " + std::to_string(crossings.size()) + " places, for example faces " +
             std::to_string(crossings[0].first) + " and " + std::to_string(crossings[0].second),
         "move its vertices apart there");
  }
  if (signed_volume(cage) < 0) cage.F = cage.F.rowwise().reverse().eval();
  require_enclosed(name, must_enclose, clearance,
                   [&](double wanted) { return points_not_inside(cage, must_enclose, wanted); });
  return cage;
}

}  // namespace vivify::meshing
