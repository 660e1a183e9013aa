// The shapes of colliders, each in its own file; the table is in sim/contact/collider_shape.cpp.
#pragma once

#include <memory>
#include <string>

#include "sim/contact/collider_shape.h"

namespace vivify::sim {

Schema plane_schema();
std::unique_ptr<ColliderShape> make_plane(const Value& settings, const ShapePlace& place);

Schema sphere_schema();
std::unique_ptr<ColliderShape> make_sphere(const Value& settings, const ShapePlace& place);

Schema capsule_schema();
std::unique_ptr<ColliderShape> make_capsule(const Value& settings, const ShapePlace& place);

Schema height_field_schema();
std::unique_ptr<ColliderShape> make_height_field(const Value& settings, const ShapePlace& place);

// A triangle surface, outward oriented; it need not be closed. Vertices in the same place are one; an open
// surface has no inside beyond its rim. Throws Error(geometry) as check_collider_surface does; `name` is for
// messages.
std::unique_ptr<ColliderShape> make_mesh_shape(const std::string& name, TriangleMesh surface);

// The surface round the segment from a to b, at the distance `radius`; a sphere when they are one point.
TriangleMesh round_surface(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius);

}  // namespace vivify::sim
