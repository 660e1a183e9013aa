#include "pipeline/placement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>

#include "common/error.h"
#include "common/mesh_io.h"
#include "common/text.h"

namespace vivify::pipeline {
namespace {

Schema looks_schema() {
  return dictionary(
      "Material of each part of the asset, by the name of the part in its file. `all` stands for every part "
      "that is not named; without it such a part is grey.",
      string("Name of a material."));
}

}  // namespace

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

std::vector<std::string> part_materials(const Value& item, const std::vector<std::string>& part_names) {
  const Value& looks = item["looks"];
  for (const auto& [part, material] : looks.entries()) {
    if (part == "all" || std::find(part_names.begin(), part_names.end(), part) != part_names.end()) continue;
    const std::string nearest = nearest_word(part, part_names);
    throw Error(ErrorKind::usage, item["name"].as_string() + ": its mesh has no part called '" + part + "'",
                !nearest.empty()     ? "did you mean '" + nearest + "'?"
                : part_names.empty() ? "its parts have no names; `all` stands for the whole mesh"
                                     : "its parts are " + join_words(part_names),
                material.where());
  }
  const std::string others = looks.has("all") ? looks["all"].as_string() : kDefaultMaterial;
  std::vector<std::string> materials;
  for (const std::string& part : part_names) {
    materials.push_back(looks.has(part) ? looks[part].as_string() : others);
  }
  if (materials.empty()) materials.push_back(others);
  return materials;
}

}  // namespace vivify::pipeline
