#include "pipeline/collider_settings.h"

#include "pipeline/placement.h"
#include "sim/contact/shapes/shapes.h"

namespace vivify::pipeline {
namespace {

Schema key_schema() {
  return object("Where the object is at a time.")
      .field("t_s", number("Time; 0 is the first frame.").unit("s").required())
      .field(
          "position",
          vector("Where the origin of the asset is then. Left out: `position` of the object.", 3).unit("m"))
      .field("rotation_deg",
             vector("Turns about the x, then the y, then the z axis of the world, after `heading_deg`.", 3)
                 .unit("deg")
                 .initially({0, 0, 0}));
}

bool moves(const Value& collider) { return !collider["motion"].items().empty(); }

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
  return placed_schema(
             "An object that bodies touch: a `mesh` or a `shape`. It stands, or moves along keyframes, "
             "whatever "
             "comes in its way.",
             false)
      .field("shape", sim::collider_shape_schema())
      .field("friction",
             number("Coulomb coefficient; inf never slips.").at_least(0).infinite().initially(1.0))
      .field(
          "motion",
          list("Keyframes of its motion, which goes smoothly through them without overshooting. Before the "
               "first and after the last it rests.",
               key_schema()))
      .field(
          "repeat_motion",
          boolean("Whether the motion is repeated, with the time from the first to the last keyframe as its "
                  "period.")
              .initially(false))
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
  if (collider["repeat_motion"].as_bool() && !moves(collider)) {
    errors.emplace_back(ErrorKind::usage, where + ".repeat_motion does not fit: there is no motion",
                        "give it keyframes, `motion`", collider["repeat_motion"].where());
  }
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
  std::vector<sim::RigidKey> keys;
  for (const Value& item : collider["motion"].items()) {
    const Value& position = item.has("position") ? item["position"] : collider["position"];
    keys.push_back(
        {item["t_s"].as_number(), position.as_vector3(), item["rotation_deg"].as_vector3(), item.where()});
  }
  return {std::move(keys), collider["repeat_motion"].as_bool(), where + ".motion"};
}

void add_collider_geometry(ContentKey& key, const Scene& scene, const Value& collider) {
  for (const char* part : {"position", "scale", "heading_deg", "shape", "motion", "repeat_motion"}) {
    key.add(part, collider[part]);
  }
  if (collider.has("mesh")) key.add_mesh_file(scene.resolve_path(collider["mesh"].as_string()));
}

}  // namespace vivify::pipeline
