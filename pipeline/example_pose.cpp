#include "pipeline/example_pose.h"

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

// The vertices of a surface that has the triangles of the shell in the same order (#V by 3).
RowMatrixXd shell_pose(const TriangleMesh& surface, const SimMesh& rest, const Value& file) {
  if (surface.F.rows() != rest.E.rows()) {
    fail(file,
         "has " + std::to_string(surface.F.rows()) + " triangles and the body has " +
             std::to_string(rest.E.rows()),
         "move the vertices of the body's own mesh and change nothing else");
  }
  RowMatrixXd pose(rest.V.rows(), 3);
  for (Eigen::Index f = 0; f < rest.E.rows(); ++f) {
    for (int k = 0; k < 3; ++k) pose.row(rest.E(f, k)) = surface.V.row(surface.F(f, k));
  }
  for (Eigen::Index f = 0; f < rest.E.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      if (pose.row(rest.E(f, k)) == surface.V.row(surface.F(f, k))) continue;
      fail(file, "joins its triangles in another way than the body, at triangle " + std::to_string(f),
           "move the vertices of the body's own mesh and change nothing else");
    }
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
  if (body_kind(body) == BodyKind::shell) {
    TriangleMesh surface = read_mesh(path);
    place(body, surface.V);
    return shell_pose(surface, rest, file);
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
