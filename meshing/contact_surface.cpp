#include "meshing/contact_surface.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "meshing/byte_stream.h"
#include "meshing/closest_point.h"
#include "meshing/coarsen.h"
#include "meshing/guarded_process.h"
#include "meshing/polygons.h"
#include "meshing/polyline.h"

namespace vivify::meshing {
namespace {

constexpr double kMore = 1.25;  // times the points when they were too few

Points face_middles(const TriangleMesh& mesh) {
  Points middles(mesh.F.rows(), 3);
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    middles.row(f) = (mesh.V.row(mesh.F(f, 0)) + mesh.V.row(mesh.F(f, 1)) + mesh.V.row(mesh.F(f, 2))) / 3;
  }
  return middles;
}

double farthest(const Points& points, const ClosestPoint& surface) {
  double distance = 0;
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    distance = std::max(distance, surface(points.row(i)).distance);
  return distance;
}

double deviation_of(const TriangleMesh& coarse, const TriangleMesh& closed, const ClosestPoint& drawn) {
  return std::max({farthest(closed.V, ClosestPoint(coarse)), farthest(coarse.V, drawn),
                   farthest(face_middles(coarse), drawn)});
}

TriangleMesh on_surface(TriangleMesh mesh, const ClosestPoint& surface) {
  for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) mesh.V.row(v) = surface(mesh.V.row(v)).point.transpose();
  return mesh;
}

// The collapsed surface, with its vertices where the quadrics put them or on the drawn surface, whichever is
// nearer to the drawn one.
TriangleMesh coarsened(const TriangleMesh& closed, int points) {
  const ClosestPoint drawn(closed);
  for (double count = points; count < static_cast<double>(closed.V.rows()); count *= kMore) {
    const TriangleMesh collapsed = collapse_surface(closed, static_cast<int>(count));
    TriangleMesh best;
    double least = std::numeric_limits<double>::infinity();
    for (const TriangleMesh& mesh : {collapsed, on_surface(collapsed, drawn)}) {
      if (signed_volume(mesh) <= 0 || intersects_itself(mesh)) continue;
      const double deviation = deviation_of(mesh, closed, drawn);
      if (deviation >= least) continue;
      least = deviation;
      best = mesh;
    }
    if (best.F.rows() > 0) return best;
  }
  return closed;
}

}  // namespace

CoarseSurface coarse_contact_surface(const TriangleMesh& closed, const TetMesh& mesh, int points,
                                     const ProcessLimits& limits) {
  TriangleMesh coarse;
  const Bytes bytes = run_guarded("simplifying the contact surface",
                                  "repair the surface or ask for fewer points", limits, [&] {
                                    coarse = coarsened(closed, points);
                                    return ByteWriter().put(coarse.V).put(coarse.F).take();
                                  });
  ByteReader reader(bytes);
  reader.get(coarse.V);
  reader.get(coarse.F);
  return {coarse.V, coarse.F, embed(mesh, coarse.V), deviation_of(coarse, closed, ClosestPoint(closed))};
}

CoarseSurface coarse_contact_outline(const Outline& outline, const Points2& V, const Triangles& F,
                                     int points) {
  // Sections from corner to corner, those of one loop after the other.
  std::vector<Points2> sections;
  std::vector<double> lengths;
  std::vector<std::size_t> last;  // section of each loop
  for (const Points2& loop : outline.loops) {
    std::vector<int> corners = corners_of(loop, true);
    if (corners.empty()) corners = {0};
    for (std::size_t k = 0; k < corners.size(); ++k) {
      sections.push_back(section(loop, corners[k], corners[(k + 1) % corners.size()]));
      lengths.push_back(arc_length(sections.back()));
    }
    last.push_back(sections.size());
  }
  const std::vector<int> pieces = share_pieces(lengths, points);
  std::vector<Points2> loops;
  std::size_t k = 0;
  for (const std::size_t end : last) {
    std::vector<Eigen::RowVector2d> loop;
    for (; k < end; ++k) {
      const Points2 spread = spread_evenly(sections[k], pieces[k]);
      for (Eigen::Index i = 0; i + 1 < spread.rows(); ++i) loop.emplace_back(spread.row(i));
    }
    loops.emplace_back(static_cast<Eigen::Index>(loop.size()), 2);
    for (std::size_t i = 0; i < loop.size(); ++i) loops.back().row(static_cast<Eigen::Index>(i)) = loop[i];
  }
  const bool degenerate =
      std::any_of(loops.begin(), loops.end(), [](const Points2& loop) { return loop.rows() < 3; });
  if (degenerate || meeting_edges(loops).first >= 0) loops = outline.loops;

  CoarseSurface surface;
  Eigen::Index count = 0;
  for (const Points2& loop : loops) count += loop.rows();
  surface.V.resize(count, 2);
  surface.F.resize(count, 2);
  Eigen::Index first = 0;
  for (const Points2& loop : loops) {
    const Eigen::Index n = loop.rows();
    surface.V.middleRows(first, n) = loop;
    for (Eigen::Index i = 0; i < n; ++i) {
      surface.F.row(first + i) << static_cast<int>(first + i), static_cast<int>(first + (i + 1) % n);
      const Eigen::Vector2d middle = (loop.row(i) + loop.row((i + 1) % n)).transpose() / 2;
      surface.deviation = std::max(surface.deviation, distance_to(outline.loops, middle));
    }
    first += n;
  }
  for (const Points2& loop : outline.loops) {
    for (Eigen::Index i = 0; i < loop.rows(); ++i) {
      surface.deviation = std::max(surface.deviation, distance_to(loops, loop.row(i).transpose()));
    }
  }
  surface.embedding = embed(V, F, Points2(surface.V));
  return surface;
}

}  // namespace vivify::meshing
