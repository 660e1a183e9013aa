// A static triangle mesh that characters collide with.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/mesh.h"

namespace vivify::sim {

// The place of a collider's surface nearest to a query point.
struct SurfacePoint {
  Eigen::Vector3d position;
  Eigen::Vector3d normal;  // unit, outward; the direction of steepest growth of the signed distance
  double distance;         // signed, metres; negative inside
};

class Collider {
 public:
  // `surface` is outward oriented; it need not be closed (a table top may be a single quad). `friction` is
  // Coulomb's μ and may be infinite: the unlimited springs of the paper. Throws Error(geometry) for an empty
  // or degenerate surface. Vertices in the same place are one; an open surface has no inside beyond its rim.
  Collider(std::string name, TriangleMesh surface, double friction);
  ~Collider();
  Collider(Collider&&) noexcept;
  Collider& operator=(Collider&&) noexcept;

  const std::string& name() const { return name_; }
  double friction() const { return friction_; }

  // The nearest surface point. The sign comes from the angle-weighted pseudo-normal of the nearest feature
  // (Bærentzen and Aanæs 2005), so it is right at edges and corners too.
  SurfacePoint nearest(const Eigen::Vector3d& point) const;

 private:
  struct Tree;
  std::string name_;
  TriangleMesh surface_;
  double friction_;
  std::unique_ptr<Tree> tree_;
};

}  // namespace vivify::sim
