// Which features of two surfaces, or of one with itself, are near one another.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "sim/contact/broad_phase.h"
#include "sim/contact/contact_surface.h"

namespace vivify::sim {

// Sine of the angle by which a direction may be outside the cone of an edge's outward normals.
inline constexpr double kConeSlack = 0.1;

// Two near places y_a and y_b of the surfaces a and b (the same surface for self-contact), each a convex
// combination of points: distance = normal · (y_a − y_b).
struct SurfacePair {
  enum Kind { point_face, face_point, edge_edge };  // of a, of b; faces are edges in the plane
  Kind kind;
  // What the pair is called from step to step: the point, the other −1; or both edges.
  int feature_a, feature_b;
  std::array<int, 3> a, b;  // points; −1 and weight 0 where there are fewer
  std::array<double, 3> weight_a, weight_b;
  Eigen::Vector3d normal;  // unit, from b towards a
  // Between the surfaces without their radii, m. Negative where they interpenetrate; never where both (of a
  // point and a face: the face's surface) are two-sided.
  double distance;
};

// A place of a surface near a point.
struct SurfacePlace {
  int side;  // face, edge in the plane
  std::array<int, 3> points;
  std::array<double, 3> weights;
  Eigen::Vector3d normal;  // unit, towards the point where that is outside; two-sided: towards the point
  double distance;         // m; negative inside
};

// Where a contact surface is, with its connections and trees of boxes.
class SurfaceState {
 public:
  // At rest. The surface is kept by reference. Throws Error(geometry) when a face has an edge that is not in
  // surface.edges.
  explicit SurfaceState(const ContactSurface& surface);

  // Moves the points to vertex positions x of the simulation mesh; O(#P + #E + #F).
  void move_to(const Eigen::VectorXd& x);

  const ContactSurface& surface() const { return *surface_; }
  const Points& points() const { return points_; }  // #P by 3
  Eigen::Vector3d point(int i) const { return points_.row(i).transpose(); }
  // Faces, or edges in the plane: #S by 3 or 2.
  const RowMatrixXi& sides() const { return surface_->planar() ? surface_->edges : surface_->faces; }
  const BoxTree& side_tree() const { return side_tree_; }
  const BoxTree& edge_tree() const { return edge_tree_; }  // empty in the plane
  BoundingBox box() const { return side_tree_.box(); }
  double mean_edge() const { return mean_edge_; }  // length at rest, m

  // The place of the surface nearest to y, if it is within `reach`. The sign of the distance is that of the
  // angle-weighted pseudo-normal (Bærentzen and Aanæs 2005); beyond the rim of an open surface it is
  // positive.
  std::optional<SurfacePlace> nearest(const Eigen::Vector3d& y, double reach) const;

  // Unit normals; zero for sides without area. Points and edges: the pseudo-normal.
  Eigen::Vector3d side_normal(int side) const;
  Eigen::Vector3d point_normal(int point) const;
  // Whether an edge is, on the side of the unit vector n (perpendicular to it), nearer than all that
  // surrounds it: the cone of its outward normals. Shells have none: all around each edge belongs to it,
  // because what moves over a shell may cross an edge that was not the nearest when the step began. `slack`:
  // sine of the angle by which n may be outside.
  bool edge_cone_has(int edge, const Eigen::Vector3d& n, double slack = kConeSlack) const;

 private:
  friend std::vector<SurfacePair> near_self_pairs(const SurfaceState& a, double reach);

  // Lists of integers, one after the other.
  struct Lists {
    std::vector<int> first, items;
    std::span<const int> operator[](int i) const {
      return {items.data() + first[i], items.data() + first[i + 1]};
    }
  };
  static Lists lists_of(const RowMatrixXi& table, int count);
  template <class Allow>
  std::optional<SurfacePlace> nearest_allowed(const Eigen::Vector3d& y, double reach,
                                              const Allow& allow) const;

  const ContactSurface* surface_;
  Points points_;
  RowMatrixXi side_edges_;  // #F by 3: edge from corner k to the next; empty in the plane
  Lists point_sides_, edge_sides_;
  BoxTree side_tree_, edge_tree_;
  double mean_edge_ = 0;
};

// All near places of two surfaces of the same dimension with distance ≤ `reach`, sorted by kind and features:
//  - for each point of one the nearest place of the other, however deep inside a solid it is;
//  - in space, sharp edges whose nearest places are inside both, and whose connecting direction is an outward
//    normal of both, so that no point describes the contact. Edges of solids that have crossed are
//    found down to the depth max(reach, mean_edge / 4).
std::vector<SurfacePair> near_pairs(const SurfaceState& a, const SurfaceState& b, double reach);

// The same of one surface with itself (point_face and edge_edge). Features that share points, or that are
// nearer than twice `reach` at rest, never touch; sides of solids touch only when they face each other, and
// down to a depth of `reach` and a quarter of their distance at rest: what is deeper is squashed material.
std::vector<SurfacePair> near_self_pairs(const SurfaceState& a, double reach);

// Two edges that touched on the side `normal` (unit, from b towards a), wherever they are now, while their
// nearest places are inside both. The direction between them may be a little farther outside the cones of
// outward normals than where a contact begins: else one at the border would come and go from step to step.
std::optional<SurfacePair> kept_edge_pair(const SurfaceState& a, int edge_a, const SurfaceState& b,
                                          int edge_b, const Eigen::Vector3d& normal);

// Whether the boxes of two surfaces are within `reach` of each other.
bool boxes_near(const SurfaceState& a, const SurfaceState& b, double reach);

}  // namespace vivify::sim
