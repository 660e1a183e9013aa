// Closest points of points, segments and triangles.
#pragma once

#include <Eigen/Core>
#include <array>

namespace vivify::sim {

// A place of a triangle or segment: a convex combination of its corners.
struct TrianglePlace {
  Eigen::Vector3d position;
  std::array<double, 3> weights;
  int feature;  // the smallest that it lies on: 0 the face, 1–3 the corner, 4–6 the edge from corner k − 4 to
                // the next
};

// The point of the triangle a b c nearest to p, by the regions of its barycentric coordinates (Ericson 2005,
// 5.1.5). Triangles without area are three segments.
TrianglePlace nearest_on_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                  const Eigen::Vector3d& b, const Eigen::Vector3d& c);

// The point of the segment a b nearest to p: feature 1 or 2 for its ends, 4 between them; the last weight is
// zero.
TrianglePlace nearest_on_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                 const Eigen::Vector3d& b);

// The nearest points a0 + s (a1 − a0) and b0 + t (b1 − b0) of two segments, s and t in [0, 1].
struct SegmentPlaces {
  double s, t;
  Eigen::Vector3d offset;  // from b to a
};
SegmentPlaces nearest_on_segments(const Eigen::Vector3d& a0, const Eigen::Vector3d& a1,
                                  const Eigen::Vector3d& b0, const Eigen::Vector3d& b1);

// The angle of the corner at `corner`, radians; zero when a side has no length. It weights the face normals
// in the pseudo-normal of a corner (Bærentzen and Aanæs 2005).
double corner_angle(const Eigen::Vector3d& corner, const Eigen::Vector3d& next, const Eigen::Vector3d& last);

// v / |v|, or `fallback` when v is zero.
Eigen::Vector3d unit_or(const Eigen::Vector3d& v, const Eigen::Vector3d& fallback);

}  // namespace vivify::sim
