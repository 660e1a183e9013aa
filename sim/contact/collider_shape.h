// What a collider is made of: a shape that knows its signed distance, and the table of all such shapes.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <span>
#include <string_view>

#include "common/mesh.h"
#include "common/schema.h"

namespace vivify::sim {

// The place of a collider's surface nearest to a query point.
struct SurfacePoint {
  Eigen::Vector3d position;
  Eigen::Vector3d normal;  // unit, outward; the direction of steepest growth of the signed distance
  double distance;         // signed, metres; negative inside
};

class ColliderShape {
 public:
  virtual ~ColliderShape() = default;
  // Query and answer are in the frame of the collider.
  virtual SurfacePoint nearest(const Eigen::Vector3d& point) const = 0;
  // Outward triangles to draw it with.
  virtual TriangleMesh drawing() const = 0;
};

// Where a shape is put in the frame of its collider: it is scaled first.
struct ShapePlace {
  double scale = 1;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();

  Eigen::Vector3d point(const Eigen::Vector3d& p) const { return pose * (scale * p); }
};

struct ColliderShapeEntry {
  std::string_view name;
  Schema (*schema)();
  // Throws Error(usage) for settings that make no shape.
  std::unique_ptr<ColliderShape> (*make)(const Value& settings, const ShapePlace& place);
};

std::span<const ColliderShapeEntry> collider_shapes();

// The setting `shape` of a collider.
Schema collider_shape_schema();
std::unique_ptr<ColliderShape> make_collider_shape(const Value& settings, const ShapePlace& place);

}  // namespace vivify::sim
