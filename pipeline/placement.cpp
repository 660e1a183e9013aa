#include "pipeline/placement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>

#include "common/error.h"
#include "common/mesh_io.h"
#include "common/text.h"

namespace vivify::pipeline {

void place(const Value& item, Points& V) {
  const double scale = item["scale"].as_number();
  const double heading = item["heading_deg"].as_number() * std::numbers::pi / 180;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const Eigen::RowVector3d position = item["position"].as_vector3().transpose();
  V = ((scale * V) * turn.transpose()).rowwise() + position;
}

TriangleMesh read_placed_mesh(const Scene& scene, const Value& item) {
  try {
    TriangleMesh mesh = read_mesh(scene.resolve_path(item["mesh"].as_string()));
    place(item, mesh.V);
    return mesh;
  } catch (const Error& error) {
    throw Error(error.kind(), item["name"].as_string() + ": " + error.what(), error.hint(),
                item["mesh"].where());
  }
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
