#include "meshing/extrude.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "common/error.h"
#include "common/log.h"
#include "common/text.h"
#include "meshing/planar_mesh.h"
#include "meshing/refine_plane.h"

namespace vivify::meshing {
namespace {

constexpr int kBevelSteps = 3;            // chords of the quarter circle
constexpr double kLongestMitre = 2;       // at sharp corners, over the bevel
constexpr double kMostTriangles = 20000;  // of the front, about

// The loop with its edges moved inward (to the left) by `distance`.
Points2 moved_inward(const Points2& loop, double distance) {
  const Eigen::Index n = loop.rows();
  Points2 moved(n, 2);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector2d in = (loop.row(i) - loop.row((i + n - 1) % n)).normalized(),
                          out = (loop.row((i + 1) % n) - loop.row(i)).normalized();
    const Eigen::Vector2d left_in(-in.y(), in.x()), left_out(-out.y(), out.x());
    Eigen::Vector2d mitre = (left_in + left_out) / std::max(1e-6, 1 + left_in.dot(left_out));
    if (mitre.norm() > kLongestMitre) mitre *= kLongestMitre / mitre.norm();
    moved.row(i) = loop.row(i) + distance * mitre.transpose();
  }
  return moved;
}

// All loops moved inward, or nothing when they then cross, turn over or leave the outline.
std::vector<Points2> inset(const Outline& outline, double distance) {
  std::vector<Points2> loops;
  for (const Points2& loop : outline.loops) {
    loops.push_back(moved_inward(loop, distance));
    if (!(signed_area(loops.back()) * signed_area(loop) > 0)) return {};
    for (Eigen::Index i = 0; i < loop.rows(); ++i) {
      if (winding_number(outline.loops, loops.back().row(i).transpose()) != 1) return {};
      const Eigen::Index j = (i + 1) % loop.rows();
      const Eigen::RowVector2d before = loop.row(j) - loop.row(i),
                               after = loops.back().row(j) - loops.back().row(i);
      if (!(before.dot(after) > 0)) return {};
    }
  }
  if (meeting_edges(loops).first >= 0) return {};
  return loops;
}

// A vertex on the rim of the front: between corners `corner` and the next one of a loop.
struct RimPoint {
  int vertex;  // of the front
  std::size_t loop;
  Eigen::Index corner;
  double place;
};

[[noreturn]] void touches() {
  throw Error(ErrorKind::geometry, "an outline that touches itself cannot be pushed out with sharp edges",
              "round the edges a little");
}

// The rim of each loop in order.
std::vector<std::vector<RimPoint>> rims_of(const PlaneTriangles& front, const std::vector<Points2>& loops) {
  const std::map<int, int> next = next_on_boundary(front.F);
  std::vector<std::vector<RimPoint>> rims;
  Eigen::Index first = 0;
  std::size_t count = 0;
  for (std::size_t l = 0; l < loops.size(); ++l) {
    const Eigen::Index n = loops[l].rows();
    std::vector<RimPoint> rim;
    for (Eigen::Index i = 0; i < n; ++i) {
      const int last = front.point[first + (i + 1) % n];
      const Eigen::RowVector2d a = loops[l].row(i), edge = loops[l].row((i + 1) % n) - a;
      for (int v = front.point[first + i]; v != last; v = next.at(v)) {
        if (++count > next.size()) touches();
        rim.push_back({v, l, i, (front.V.row(v) - a).dot(edge) / edge.squaredNorm()});
      }
    }
    first += n;
    rims.push_back(std::move(rim));
  }
  if (count != next.size()) touches();
  return rims;
}

// How far inside the outline (over the bevel) and at which z the rings of the side lie, front to back.
std::vector<std::pair<double, double>> profile(double depth, double bevel, double size) {
  std::vector<std::pair<double, double>> rings;
  for (int k = 0; bevel > 0 && k < kBevelSteps; ++k) {
    const double angle = std::numbers::pi / 2 * k / kBevelSteps;
    rings.emplace_back(1 - std::sin(angle), depth / 2 - bevel * (1 - std::cos(angle)));
  }
  const double straight = depth - 2 * bevel;
  const int pieces = std::max(1, static_cast<int>(std::ceil(straight / size - 1e-9)));
  for (int k = 0; k <= pieces; ++k)
    rings.emplace_back(0.0, straight * (0.5 - static_cast<double>(k) / pieces));
  for (int k = kBevelSteps - 1; bevel > 0 && k >= 0; --k) {
    const auto [inside, z] = rings[static_cast<std::size_t>(k)];
    rings.emplace_back(inside, -z);
  }
  return rings;
}

}  // namespace

TriangleMesh extrude(const Outline& outline, double depth, double bevel) {
  if (!(depth > 0) || !(bevel >= 0) || !(2 * bevel < depth)) {
    throw Error(ErrorKind::geometry,
                "an outline cannot be pushed out by " + number_text(depth) + " m with edges rounded by " +
                    number_text(bevel) + " m",
                "the rounding must be less than half of the depth");
  }
  const double wanted_bevel = bevel, least_bevel = bevel / 100;
  std::vector<Points2> loops = bevel > 0 ? inset(outline, bevel) : outline.loops;
  while (loops.empty()) {
    bevel *= 0.7;
    if (bevel < least_bevel) bevel = 0;
    loops = bevel > 0 ? inset(outline, bevel) : outline.loops;
  }
  if (bevel < wanted_bevel) {
    log_info("edges rounded by " + number_text(bevel) + " m instead of " + number_text(wanted_bevel) +
             " m: the strokes are too thin for more");
  }

  const double size = std::max(depth / 2, std::sqrt(4 * outline.area() / kMostTriangles));
  std::optional<PlaneTriangles> refined = refine_plane(loops, {.longest_edge = size});
  if (!refined) {
    throw Error(ErrorKind::geometry, "the front of the letter takes too many triangles",
                "simplify the outline");
  }
  PlaneTriangles& front = *refined;
  improve_triangles(front.V, front.F, 3);
  const std::vector<std::vector<RimPoint>> rims = rims_of(front, loops);
  const std::vector<std::pair<double, double>> rings = profile(depth, bevel, size);

  // Front, back, then the rings between them.
  const auto face_vertices = static_cast<int>(front.V.rows());
  const auto inner_rings = static_cast<int>(rings.size()) - 2;
  int rim_size = 0;
  for (const auto& rim : rims) rim_size += static_cast<int>(rim.size());
  TriangleMesh mesh;
  mesh.V.resize(2 * face_vertices + inner_rings * rim_size, 3);
  mesh.V.topLeftCorner(face_vertices, 2) = front.V;
  mesh.V.block(face_vertices, 0, face_vertices, 2) = front.V;
  mesh.V.col(2).head(face_vertices).setConstant(depth / 2);
  mesh.V.col(2).segment(face_vertices, face_vertices).setConstant(-depth / 2);
  const Eigen::Index flat = front.F.rows();
  mesh.F.resize(2 * flat + 2 * rim_size * (inner_rings + 1), 3);
  mesh.F.topRows(flat) = front.F;
  mesh.F.middleRows(flat, flat) = front.F.rowwise().reverse().array() + face_vertices;

  Eigen::Index row = 2 * flat;
  int before = 0;  // rim points of earlier loops
  for (const std::vector<RimPoint>& rim : rims) {
    const auto n = static_cast<int>(rim.size());
    const auto vertex = [&](std::size_t ring, int j) {
      if (ring == 0) return rim[static_cast<std::size_t>(j)].vertex;
      if (ring + 1 == rings.size()) return face_vertices + rim[static_cast<std::size_t>(j)].vertex;
      return 2 * face_vertices + static_cast<int>(ring - 1) * rim_size + before + j;
    };
    for (std::size_t ring = 0; ring < rings.size(); ++ring) {
      for (int j = 0; j < n; ++j) {
        const RimPoint& point = rim[static_cast<std::size_t>(j)];
        const Points2 &outer = outline.loops[point.loop], &inner = loops[point.loop];
        const Eigen::Index next = (point.corner + 1) % outer.rows();
        const auto [inside, z] = rings[ring];
        const auto at = [&](const Points2& loop) {
          return Eigen::RowVector2d((1 - point.place) * loop.row(point.corner) +
                                    point.place * loop.row(next));
        };
        if (ring > 0 && ring + 1 < rings.size()) {
          mesh.V.row(vertex(ring, j)) << (1 - inside) * at(outer) + inside * at(inner), z;
        }
        if (ring + 1 == rings.size()) continue;
        const int k = (j + 1) % n;
        mesh.F.row(row++) << vertex(ring, j), vertex(ring + 1, j), vertex(ring + 1, k);
        mesh.F.row(row++) << vertex(ring, j), vertex(ring + 1, k), vertex(ring, k);
      }
    }
    before += n;
  }
  const Eigen::RowVector2d low = mesh.V.leftCols<2>().colwise().minCoeff(),
                           high = mesh.V.leftCols<2>().colwise().maxCoeff();
  mesh.UV = (mesh.V.leftCols<2>().rowwise() - low).array().rowwise() / (high - low).array();
  mesh.part_names = {"front", "side", "back"};
  mesh.face_part = Eigen::VectorXi::Constant(mesh.F.rows(), 1);
  mesh.face_part.head(flat).setConstant(0);
  mesh.face_part.segment(flat, flat).setConstant(2);
  return mesh;
}

}  // namespace vivify::meshing
