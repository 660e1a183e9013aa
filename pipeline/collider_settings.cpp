#include "pipeline/collider_settings.h"

#include "pipeline/motion_settings.h"
#include "pipeline/placement.h"
#include "sim/contact/shapes/shapes.h"

namespace vivify::pipeline {
namespace {

// Where the asset is put in the collider's own frame.
sim::ShapePlace own_place(const Value& collider) {
  sim::ShapePlace place;
  place.scale = collider["scale"].as_number();
  place.pose.linear() = heading_rotation(collider);
  if (!moves(collider)) place.pose.translation() = collider["position"].as_vector3();
  return place;
}

// Errors about one part of a collider get its place in the file.
template <class Make>
auto placed_errors(const Value& part, const Make& make) {
  try {
    return make();
  } catch (const Error& error) {
    if (!error.where().file.empty()) throw;
    throw Error(error.kind(), error.what(), error.hint(), part.where());
  }
}

}  // namespace

Schema collider_schema() {
  Schema collider =
      placed_schema(
          "An object that bodies touch: a `mesh` or a `shape`. It stands, or moves along keyframes, whatever "
          "comes in its way.",
          false)
          .field("shape", sim::collider_shape_schema())
          .field("friction",
                 number("Coulomb coefficient; inf never slips.").at_least(0).infinite().initially(1.0));
  return add_motion(std::move(collider), "object", "position",
                    vector("Where the origin of the asset is then. Left out: `position` of the object.", 3)
                        .unit("m"),
                    "Turns about the x, then the y, then the z axis of the world, after `heading_deg`.")
      .field("surface_velocity",
             vector("Velocity at which the surface carries along what stands on it, like a conveyor belt, in "
                    "the axes of the asset: it turns with the object.",
                    3)
                 .unit("m/s")
                 .initially({0, 0, 0}))
      .field("visible", boolean("Whether it is drawn.").initially(true));
}

void check_collider(const Value& collider, const std::string& where, std::vector<Error>& errors) {
  const bool mesh = collider.has("mesh"), shape = collider.has("shape");
  if (mesh == shape) {
    errors.emplace_back(ErrorKind::usage, where + " needs either `mesh` or `shape`", "",
                        mesh ? collider["shape"].where() : collider.where());
  }
  check_motion(collider, where, errors);
}

sim::Collider make_collider(const Scene& scene, const Value& collider, const std::string& where) {
  const double friction = collider["friction"].as_number();
  const std::string& name = collider["name"].as_string();
  sim::RigidPath path = collider_path(collider, where);
  const Eigen::Vector3d surface_velocity =
      heading_rotation(collider) * collider["surface_velocity"].as_vector3();
  std::unique_ptr<sim::ColliderShape> shape =
      collider.has("mesh")
          ? placed_errors(collider["mesh"],
                          [&] { return sim::make_mesh_shape(name, collider_surface(scene, collider)); })
          : placed_errors(collider["shape"],
                          [&] { return sim::make_collider_shape(collider["shape"], own_place(collider)); });
  return {name, std::move(shape), friction, std::move(path), surface_velocity};
}

TriangleMesh collider_surface(const Scene& scene, const Value& collider) {
  if (!collider.has("mesh")) {
    return sim::make_collider_shape(collider["shape"], own_place(collider))->drawing();
  }
  if (!moves(collider)) return read_placed_mesh(scene, collider);
  TriangleMesh mesh = read_asset(scene, collider);
  scale_and_turn(collider, mesh.V);
  return mesh;
}

sim::RigidPath collider_path(const Value& collider, const std::string& where) {
  return motion_path(collider, where, "position", collider["position"].as_vector3());
}

void add_collider_geometry(ContentKey& key, const Scene& scene, const Value& collider) {
  for (const char* part : {"position", "scale", "heading_deg", "shape", "motion", "repeat_motion"}) {
    key.add(part, collider[part]);
  }
  if (collider.has("mesh")) key.add_mesh_file(scene.resolve_path(collider["mesh"].as_string()));
}

}  // namespace vivify::pipeline
