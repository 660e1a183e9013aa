// Contours of lines and Bézier curves, as fonts and drawings give them.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "common/mesh.h"

namespace vivify::meshing {

// One contour, built piece by piece from its start.
class CurveContour {
 public:
  explicit CurveContour(const Eigen::Vector2d& start) : start_(start) {}

  void line_to(const Eigen::Vector2d& end);
  void quadratic_to(const Eigen::Vector2d& control, const Eigen::Vector2d& end);
  void cubic_to(const Eigen::Vector2d& control1, const Eigen::Vector2d& control2, const Eigen::Vector2d& end);
  // The elliptical arc of SVG 1.1 (appendix F.6): radii, rotation of the x axis (radians), which of the four
  // arcs.
  void arc_to(Eigen::Vector2d radii, double rotation, bool large, bool sweep, const Eigen::Vector2d& end);
  void close() { closed_ = true; }

  const Eigen::Vector2d& start() const { return start_; }
  const Eigen::Vector2d& end() const { return pieces_.empty() ? start_ : pieces_.back().end; }
  bool closed() const { return closed_; }
  bool empty() const { return pieces_.empty(); }

  void transform(const Eigen::Affine2d& map);

  // Corners of a polyline that stays within `tolerance` of the contour; the end is left out where it repeats
  // the start.
  Points2 flatten(double tolerance) const;
  // All end points and control points.
  Eigen::AlignedBox2d control_box() const;

 private:
  struct Piece {
    Eigen::Vector2d control1, control2, end;
    bool straight;
  };
  Eigen::Vector2d start_;
  std::vector<Piece> pieces_;
  bool closed_ = false;
};

}  // namespace vivify::meshing
