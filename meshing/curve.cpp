#include "meshing/curve.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vivify::meshing {
namespace {

constexpr double kMostChords = 1000;  // of one curve

}  // namespace

void CurveContour::line_to(const Eigen::Vector2d& end_point) {
  pieces_.push_back({end(), end_point, end_point, true});
}

void CurveContour::quadratic_to(const Eigen::Vector2d& control, const Eigen::Vector2d& end_point) {
  cubic_to(end() + 2.0 / 3 * (control - end()), end_point + 2.0 / 3 * (control - end_point), end_point);
}

void CurveContour::cubic_to(const Eigen::Vector2d& control1, const Eigen::Vector2d& control2,
                            const Eigen::Vector2d& end_point) {
  pieces_.push_back({control1, control2, end_point, false});
}

void CurveContour::arc_to(Eigen::Vector2d radii, double rotation, bool large, bool sweep,
                          const Eigen::Vector2d& end_point) {
  const Eigen::Vector2d from = end();
  if (from == end_point) return;
  radii = radii.cwiseAbs();
  if (!(radii.minCoeff() > 0)) return line_to(end_point);
  const Eigen::Rotation2Dd turn(rotation);
  // In the frame where the ellipse is a unit circle.
  const auto to_circle = [&](const Eigen::Vector2d& p) {
    return Eigen::Vector2d((turn.inverse() * p).cwiseQuotient(radii));
  };
  const double half = (to_circle(from) - to_circle(end_point)).norm() / 2;
  if (half > 1) radii *= half;
  const Eigen::Vector2d a = to_circle(from), b = to_circle(end_point), chord = b - a;
  const double height = std::sqrt(std::max(0.0, 1 - chord.squaredNorm() / 4));
  const Eigen::Vector2d left = Eigen::Vector2d(-chord.y(), chord.x()).normalized();
  const Eigen::Vector2d centre = (a + b) / 2 + (large == sweep ? -height : height) * left;
  const double first = std::atan2(a.y() - centre.y(), a.x() - centre.x());
  double span = std::atan2(b.y() - centre.y(), b.x() - centre.x()) - first;
  if (sweep && span < 0) span += 2 * std::numbers::pi;
  if (!sweep && span > 0) span -= 2 * std::numbers::pi;
  const int count = std::max(1, static_cast<int>(std::ceil(std::abs(span) / (std::numbers::pi / 4))));
  const double step = span / count, handle = 4.0 / 3 * std::tan(step / 4);
  const auto from_circle = [&](const Eigen::Vector2d& p) {
    return Eigen::Vector2d(turn * p.cwiseProduct(radii));
  };
  for (int i = 0; i < count; ++i) {
    const double s = first + i * step, t = s + step;
    const Eigen::Vector2d p(std::cos(s), std::sin(s)), q(std::cos(t), std::sin(t));
    cubic_to(from_circle(centre + p + handle * Eigen::Vector2d(-p.y(), p.x())),
             from_circle(centre + q - handle * Eigen::Vector2d(-q.y(), q.x())),
             i + 1 == count ? end_point : from_circle(centre + q));
  }
}

void CurveContour::transform(const Eigen::Affine2d& map) {
  start_ = map * start_;
  for (Piece& piece : pieces_) {
    piece.control1 = map * piece.control1;
    piece.control2 = map * piece.control2;
    piece.end = map * piece.end;
  }
}

Points2 CurveContour::flatten(double tolerance) const {
  std::vector<Eigen::Vector2d> points = {start_};
  for (const Piece& piece : pieces_) {
    const Eigen::Vector2d a = points.back(), b = piece.control1, c = piece.control2, d = piece.end;
    int count = 1;
    if (!piece.straight) {
      // A chord over a parameter step h is off by at most h²/8 times the largest second derivative.
      const double bend = 6 * std::max((a - 2 * b + c).norm(), (b - 2 * c + d).norm());
      const double chords = std::sqrt(bend / 8 / tolerance);
      if (chords > 1) count = static_cast<int>(std::ceil(std::min(chords, kMostChords)));
    }
    for (int i = 1; i < count; ++i) {
      const double t = static_cast<double>(i) / count, u = 1 - t;
      points.emplace_back(u * u * u * a + 3 * u * u * t * b + 3 * u * t * t * c + t * t * t * d);
    }
    points.push_back(d);
  }
  if (points.size() > 1 && points.back() == points.front()) points.pop_back();
  Points2 result(static_cast<Eigen::Index>(points.size()), 2);
  for (std::size_t i = 0; i < points.size(); ++i) result.row(static_cast<Eigen::Index>(i)) = points[i];
  return result;
}

Eigen::AlignedBox2d CurveContour::control_box() const {
  Eigen::AlignedBox2d box(start_);
  for (const Piece& piece : pieces_) {
    box.extend(piece.control1);
    box.extend(piece.control2);
    box.extend(piece.end);
  }
  return box;
}

}  // namespace vivify::meshing
