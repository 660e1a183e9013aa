#include "pipeline/placement.h"

#include <Eigen/Geometry>
#include <numbers>

#include "common/error.h"
#include "common/mesh_io.h"
#include "pipeline/looks.h"

namespace vivify::pipeline {
Schema placed_schema(std::string doc, bool mesh_required) {
  Schema mesh = path("Surface: OBJ, PLY, OFF, STL, glTF or GLB, in metres, +Y up.");
  if (mesh_required) mesh = std::move(mesh).required();
  return object(std::move(doc))
      .field("name", string("Name of the object: letters, digits, '-' and '_'.").required())
      .field("mesh", std::move(mesh))
      .field("position", vector("Where the origin of the asset is put.", 3).unit("m").initially({0, 0, 0}))
      .field("scale", number("Size factor, applied first.").above(0).initially(1.0))
      .field("heading_deg", number("Turn about +Y, applied after the scale; 0 looks along +Z, 90 along +X.")
                                .unit("deg")
                                .initially(0.0))
      .field("looks", looks_schema());
}

Eigen::Matrix3d heading_rotation(const Value& item) {
  const double heading = item["heading_deg"].as_number() * std::numbers::pi / 180;
  return Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitY()).toRotationMatrix();
}

void scale_and_turn(const Value& item, Points& V) {
  V = ((item["scale"].as_number() * V) * heading_rotation(item).transpose()).eval();
}

void place(const Value& item, Points& V) {
  scale_and_turn(item, V);
  V.rowwise() += item["position"].as_vector3().transpose();
}

void place(const Value& item, Points2& V) {
  const Eigen::RowVector2d position = item["position"].as_vector3().head<2>().transpose();
  V = (item["scale"].as_number() * V).rowwise() + position;
}

TriangleMesh read_asset(const Scene& scene, const Value& item) {
  try {
    return read_mesh(scene.resolve_path(item["mesh"].as_string()));
  } catch (const Error& error) {
    throw Error(error.kind(), item["name"].as_string() + ": " + error.what(), error.hint(),
                item["mesh"].where());
  }
}

TriangleMesh read_placed_mesh(const Scene& scene, const Value& item) {
  TriangleMesh mesh = read_asset(scene, item);
  place(item, mesh.V);
  return mesh;
}

}  // namespace vivify::pipeline
