#include "meshing/tapered_box.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace vivify::meshing {
namespace {

constexpr double kLeastTaper = 0.4;     // smaller over larger side
constexpr double kWorthTurning = 0.85;  // volume turned over volume upright
constexpr int kSlopes = 81;             // odd, so that a straight box is among them
constexpr int kAngles = 18;             // in a quarter turn

// Half-width of the slab |u - centre| <= half + slope * t around points (t, u), t in [0, 1].
struct Slab {
  double centre, half, slope;
};

// The narrowest slabs over a range of slopes, each with `margin` to the points.
std::vector<Slab> slabs(const Eigen::VectorXd& t, const Eigen::VectorXd& u, double height, double margin) {
  const double steepest = (u.maxCoeff() - u.minCoeff()) / 2;
  std::vector<Slab> result;
  for (int i = 0; i < kSlopes; ++i) {
    const double slope = steepest * (2.0 * i / (kSlopes - 1) - 1);
    const double high = (u - slope * t).maxCoeff(), low = (u + slope * t).minCoeff();
    const double half = (high - low) / 2 + margin * std::hypot(1.0, slope / height);
    const double small = std::min(half, half + slope), large = std::max(half, half + slope);
    if (small >= kLeastTaper * large) result.push_back({(high + low) / 2, half, slope});
  }
  return result;
}

struct Candidate {
  double volume = std::numeric_limits<double>::infinity();
  double angle = 0, low = 0, height = 0;
  Slab x{}, z{};
};

Candidate smallest_box(const Points& points, double angle, double clearance) {
  const double c = std::cos(angle), s = std::sin(angle);
  const Eigen::VectorXd u = c * points.col(0) + s * points.col(2), w = c * points.col(2) - s * points.col(0);
  Candidate best;
  best.angle = angle;
  best.low = points.col(1).minCoeff() - clearance;
  best.height = points.col(1).maxCoeff() + clearance - best.low;
  const Eigen::VectorXd t = (points.col(1).array() - best.low) / best.height;
  const std::vector<Slab> across = slabs(t, u, best.height, clearance),
                          along = slabs(t, w, best.height, clearance);
  for (const Slab& x : across) {
    for (const Slab& z : along) {
      // Integral of the product of the two widths over the height.
      const double volume =
          4 * best.height *
          (x.half * z.half + (x.half * z.slope + x.slope * z.half) / 2 + x.slope * z.slope / 3);
      if (volume < best.volume) {
        best.volume = volume;
        best.x = x;
        best.z = z;
      }
    }
  }
  return best;
}

}  // namespace

TriangleMesh tapered_box(const Points& points, double clearance) {
  const Candidate upright = smallest_box(points, 0, clearance);
  Candidate best = upright;
  const auto try_angle = [&](double angle) {
    const Candidate turned = smallest_box(points, angle, clearance);
    if (turned.volume < best.volume) best = turned;
  };
  constexpr double kStep = std::numbers::pi / 2 / kAngles;
  for (int i = 1; i < kAngles; ++i) try_angle(i * kStep);
  const double nearly = best.angle;
  for (int i = -4; i <= 4; ++i) try_angle(nearly + i * kStep / 5);
  if (best.volume > kWorthTurning * upright.volume) best = upright;
  TriangleMesh box;
  box.V.resize(8, 3);
  const double c = std::cos(best.angle), s = std::sin(best.angle);
  for (int i = 0; i < 8; ++i) {
    const double top = i & 2 ? 1 : 0;
    const double u = best.x.centre + (i & 1 ? 1 : -1) * (best.x.half + top * best.x.slope);
    const double w = best.z.centre + (i & 4 ? 1 : -1) * (best.z.half + top * best.z.slope);
    box.V.row(i) << c * u - s * w, best.low + top * best.height, s * u + c * w;
  }
  box.F.resize(12, 3);
  box.F << 0, 4, 6, 0, 6, 2, 1, 3, 5, 3, 7, 5, 0, 1, 5, 0, 5, 4, 2, 6, 3, 3, 6, 7, 0, 2, 3, 0, 3, 1, 4, 5, 6,
      5, 7, 6;
  return box;
}

Points2 tapered_rectangle(const Points2& points, double clearance) {
  const double low = points.col(1).minCoeff() - clearance;
  const double height = points.col(1).maxCoeff() + clearance - low;
  const Eigen::VectorXd t = (points.col(1).array() - low) / height;
  const std::vector<Slab> across = slabs(t, points.col(0), height, clearance);
  const Slab best = *std::min_element(across.begin(), across.end(), [](const Slab& a, const Slab& b) {
    return a.half + a.slope / 2 < b.half + b.slope / 2;  // mean width
  });
  Points2 corners(4, 2);
  corners << best.centre - best.half, low, best.centre + best.half, low, best.centre + best.half + best.slope,
      low + height, best.centre - best.half - best.slope, low + height;
  return corners;
}

}  // namespace vivify::meshing
