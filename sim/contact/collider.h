// An object that characters collide with. It stands, moves along keyframes, or carries what stands on it
// along like a conveyor.
#pragma once

#include <memory>
#include <string>

#include "common/mesh.h"
#include "sim/contact/collider_shape.h"
#include "sim/contact/rigid_path.h"

namespace vivify::sim {

class Collider {
 public:
  // A static triangle surface, in the world. Throws Error(geometry) for an empty, degenerate, leaking or
  // wrongly oriented surface (sim/contact/surface_check.h). `friction` is Coulomb's μ and may be infinite:
  // the unlimited springs of the paper.
  Collider(std::string name, TriangleMesh surface, double friction);
  // `shape` is in the collider's own frame, which `motion` moves through the world; `surface_velocity` is in
  // that frame too.
  Collider(std::string name, std::unique_ptr<ColliderShape> shape, double friction, RigidPath motion = {},
           const Eigen::Vector3d& surface_velocity = Eigen::Vector3d::Zero());

  const std::string& name() const { return name_; }
  double friction() const { return friction_; }
  const ColliderShape& shape() const { return *shape_; }

  // The nearest surface point; `point` and answer are in the collider's own frame. Throws Error(numerical)
  // for a point at no finite distance.
  SurfacePoint nearest(const Eigen::Vector3d& point) const;
  // The same in the world, while the collider stands at `pose`.
  SurfacePoint nearest(const Eigen::Vector3d& point, const Eigen::Isometry3d& pose) const;

  // From the collider's own frame to the world at time t (s); the identity for one that does not move.
  Eigen::Isometry3d pose(double t) const { return motion_.pose(t); }
  bool moves() const { return motion_.moves(); }
  // Velocity of the surface beside that of the motion, in the own frame (m/s). Its tangential part moves what
  // stands on the surface; the surface itself stays where it is.
  const Eigen::Vector3d& surface_velocity() const { return surface_velocity_; }

 private:
  std::string name_;
  std::unique_ptr<ColliderShape> shape_;
  double friction_;
  RigidPath motion_;
  Eigen::Vector3d surface_velocity_;
};

}  // namespace vivify::sim
