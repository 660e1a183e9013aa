#include "sim/contact/collider.h"

#include <cmath>

#include "common/error.h"
#include "sim/contact/shapes/shapes.h"

namespace vivify::sim {

Collider::Collider(std::string name, TriangleMesh surface, double friction)
    : Collider(name, make_mesh_shape(name, std::move(surface)), friction) {}

Collider::Collider(std::string name, std::unique_ptr<ColliderShape> shape, double friction, RigidPath motion,
                   const Eigen::Vector3d& surface_velocity)
    : name_(std::move(name)),
      shape_(std::move(shape)),
      friction_(friction),
      motion_(std::move(motion)),
      surface_velocity_(surface_velocity) {}

SurfacePoint Collider::nearest(const Eigen::Vector3d& point) const {
  const SurfacePoint nearest = shape_->nearest(point);
  if (!std::isfinite(nearest.distance)) {
    throw Error(ErrorKind::numerical, "collider '" + name_ + "': a point is at no finite distance",
                "the simulation has run away: raise frames.steps_per_frame");
  }
  return nearest;
}

SurfacePoint Collider::nearest(const Eigen::Vector3d& point, const Eigen::Isometry3d& pose) const {
  if (!moves()) return nearest(point);
  SurfacePoint place = nearest(pose.inverse() * point);
  place.position = pose * place.position;
  place.normal = pose.linear() * place.normal;
  return place;
}

}  // namespace vivify::sim
