#include "pipeline/example_pose.h"

#include <array>
#include <map>
#include <optional>

#include "common/error.h"
#include "common/mesh_io.h"
#include "pipeline/body_settings.h"
#include "pipeline/placement.h"
#include "pipeline/pose_file.h"

namespace vivify::pipeline {
namespace {

[[noreturn]] void fail(const Value& file, const std::string& problem, const std::string& hint) {
  throw Error(ErrorKind::geometry, "the example " + file.as_string() + " " + problem, hint, file.where());
}

// Whether two surfaces have the same triangles in the same order, each between the same vertices.
bool same_triangles(const TriangleMesh& a, const TriangleMesh& b) {
  return a.V.rows() == b.V.rows() && a.F.rows() == b.F.rows() && a.F == b.F;
}

// The posed places of the vertices of a shell that keeps the triangles of its file (#V by 3); nothing when
// the pose has other triangles. Drawn vertices in the same place are one vertex of the shell.
std::optional<Points> shell_pose(const Scene& scene, const Value& body, const TriangleMesh& posed,
                                 const Points& rest) {
  const TriangleMesh surface = read_placed_mesh(scene, body);
  if (!same_triangles(surface, posed)) return std::nullopt;
  std::map<std::array<double, 3>, Eigen::Index> drawn;
  for (Eigen::Index i = 0; i < surface.V.rows(); ++i) {
    drawn.emplace(std::array{surface.V(i, 0), surface.V(i, 1), surface.V(i, 2)}, i);
  }
  Points pose(rest.rows(), 3);
  for (Eigen::Index i = 0; i < rest.rows(); ++i) {
    const auto found = drawn.find({rest(i, 0), rest(i, 1), rest(i, 2)});
    if (found == drawn.end()) return std::nullopt;
    pose.row(i) = posed.V.row(found->second);
  }
  return pose;
}

}  // namespace

std::string example_name(const Value& example) {
  if (example.has("name")) return example["name"].as_string();
  const Value& file = example.has("file") ? example["file"] : example["pose"];
  return std::filesystem::path(file.as_string()).stem().string();
}

RowMatrixXd example_pose(const Scene& scene, const Value& body, const Value& example, const SimMesh& rest) {
  if (example.has("pose")) {
    std::vector<Error> errors;
    const Value pose = load_pose(scene.resolve_path(example["pose"].as_string()), errors);
    if (!errors.empty()) throw errors.front();
    return solve_pose(pose, rest, body["model"], scene.settings["gravity"].as_vector3()).V;
  }
  const Value& file = example["file"];
  const std::filesystem::path path = scene.resolve_path(file.as_string());
  const bool own_triangles = body_kind(body) == BodyKind::shell && !body["triangles"].has("vertices");
  if (own_triangles) {
    TriangleMesh posed = read_mesh(path);
    place(body, posed.V);
    if (const auto pose = shell_pose(scene, body, posed, rest.V)) return *pose;
  }
  if (path.extension() != ".ply") {
    fail(file, own_triangles ? "has other triangles than the body" : "is no PLY file",
         own_triangles ? "move the vertices of the body's own mesh and change nothing else"
                       : "make it with `vivify pose`");
  }
  Points V = read_ply_vertices(path);
  if (V.rows() != rest.V.rows()) {
    fail(file,
         "has " + std::to_string(V.rows()) + " vertices and the simulation mesh has " +
             std::to_string(rest.V.rows()),
         "make it with `vivify pose` for this very mesh");
  }
  if (rest.dimension() == 3) {
    place(body, V);
    return V;
  }
  Points2 planar = V.leftCols<2>();
  place(body, planar);
  return planar;
}

}  // namespace vivify::pipeline
