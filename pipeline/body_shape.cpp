#include "pipeline/body_shape.h"

#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "common/log.h"
#include "meshing/extrude.h"
#include "meshing/planar_mesh.h"
#include "meshing/repair.h"
#include "meshing/rod.h"
#include "meshing/shell_mesh.h"
#include "meshing/tetrahedralize.h"
#include "pipeline/body_settings.h"
#include "pipeline/looks.h"
#include "pipeline/placement.h"

namespace vivify::pipeline {
namespace {

// A point this far outside its element exaggerates the motion (meshing/embedding.h).
constexpr double kFarOutside = 2;
constexpr int kFlatVertices = 80;
constexpr double kSlender = 50;  // how many times as long as wide a triangle of a shell may be

void warn_of_far_points(const std::string& name, const meshing::Embedding& embedding, const char* key) {
  if (embedding.largest_weight() <= kFarOutside) return;
  log_warning(
      name +
      ": parts of the drawn surface lie far outside the simulation mesh and will exaggerate its motion; "
      "raise " +
      key);
}

// How many times as long as wide the most slender triangle is.
double slenderness(const SimMesh& mesh) {
  const Eigen::VectorXd area = element_sizes(mesh);
  double most = 0;
  for (Eigen::Index f = 0; f < mesh.E.rows(); ++f) {
    double longest = 0;
    for (int k = 0; k < 3; ++k)
      longest =
          std::max(longest, (mesh.V.row(mesh.E(f, k)) - mesh.V.row(mesh.E(f, (k + 1) % 3))).squaredNorm());
    most = std::max(most, longest / (2 * area[f]));
  }
  return most;
}

// Meshed before it is placed: an asset has the same simulation mesh wherever it stands.
BodyShape make_solid(const Scene& scene, const Value& body) {
  const std::string& name = body["name"].as_string();
  BodyShape shape;
  shape.surface = read_asset(scene, body);
  check_looks(body, shape.surface.part_names);  // wrong part names are told before the long work
  meshing::RepairedSurface repaired = meshing::repair_surface(shape.surface);
  for (const std::string& note : repaired.notes) log_info(name + ": " + note);
  meshing::TetrahedralizeResult result =
      meshing::tetrahedralize(repaired.mesh, meshing::tetrahedra_settings(body["tetrahedra"]));
  for (const std::string& note : result.notes) log_info(name + ": " + note);
  shape.skin.embedding = meshing::embed(result.mesh, shape.surface.V);
  warn_of_far_points(name, shape.skin.embedding, "tetrahedra.vertices");
  for (Points* V : {&shape.surface.V, &repaired.mesh.V, &result.mesh.V}) place(body, *V);
  shape.mesh = sim_mesh(result.mesh);
  shape.closed = std::move(repaired.mesh);
  shape.route = repaired.route;
  shape.notes = repaired.notes;
  shape.notes.insert(shape.notes.end(), result.notes.begin(), result.notes.end());
  return shape;
}

BodyShape make_shell(const Scene& scene, const Value& body) {
  const TriangleMesh surface = read_placed_mesh(scene, body);
  check_looks(body, surface.part_names);
  const Value& wanted = body["triangles"]["vertices"];
  const meshing::ShellMesh shell =
      meshing::shell_mesh(surface, wanted.is_null() ? 0 : static_cast<int>(wanted.as_integer()));
  for (const std::string& note : shell.notes) log_info(body["name"].as_string() + ": " + note);
  if (const double times = slenderness({shell.mesh.V, shell.mesh.F}); times > kSlender) {
    log_warning(body["name"].as_string() + ": triangles of the shell are up to " +
                std::to_string(std::lround(times)) +
                " times as long as wide and will hardly bend or not be solved; set triangles.vertices");
  }
  meshing::SkinnedSurface skinned =
      meshing::thick_shell(surface, shell.mesh.V, shell.mesh.F, body["model"]["thickness"].as_number());
  BodyShape shape;
  shape.mesh = {shell.mesh.V, shell.mesh.F};
  shape.surface = std::move(skinned.surface);
  shape.skin = std::move(skinned.skin);
  shape.notes = shell.notes;
  return shape;
}

BodyShape make_flat(const Scene& scene, const Value& body) {
  const meshing::Outline outline = placed_outline(scene, body);
  const Value& wanted = body["triangles"]["vertices"];
  const meshing::PlanarMesh mesh = meshing::triangulate_outline(
      outline, wanted.is_null() ? kFlatVertices : static_cast<int>(wanted.as_integer()));
  BodyShape shape;
  shape.surface =
      meshing::extrude(outline, body["extrude"]["depth"].as_number(), body["extrude"]["bevel"].as_number());
  shape.surface.V.col(2).array() += body["position"].as_vector3().z();
  check_looks(body, shape.surface.part_names);
  shape.skin.embedding = meshing::embed(mesh.V, mesh.F, shape.surface.V.leftCols<2>());
  shape.skin.depth = shape.surface.V.col(2);
  warn_of_far_points(body["name"].as_string(), shape.skin.embedding, "triangles.vertices");
  shape.mesh = {mesh.V, mesh.F};
  return shape;
}

BodyShape make_rod(const Scene& scene, const Value& body) {
  const auto vertices = static_cast<int>(body["edges"]["vertices"].as_integer());
  const bool open = body["outline"]["type"].as_string() == "polyline";
  Points2 line;
  if (open) {
    line = meshing::polyline_points(body["outline"]);
    place(body, line);
  } else {
    line = placed_outline(scene, body).loops.front();
  }
  const meshing::Rod rod = meshing::rod_from_polyline(line, !open, vertices);
  meshing::SkinnedSurface skinned = meshing::rod_band(
      rod.V, rod.E, body["model"]["thickness"].as_number(), body["extrude"]["depth"].as_number(),
      body["extrude"]["bevel"].as_number(), body["position"].as_vector3().z());
  BodyShape shape;
  shape.mesh = {rod.V, rod.E};
  shape.surface = std::move(skinned.surface);
  shape.skin = std::move(skinned.skin);
  check_looks(body, shape.surface.part_names);
  return shape;
}

}  // namespace

BodyShape make_body_shape(const Scene& scene, const Value& body) {
  switch (body_kind(body)) {
    case BodyKind::solid:
      return make_solid(scene, body);
    case BodyKind::shell:
      return make_shell(scene, body);
    case BodyKind::flat:
      return make_flat(scene, body);
    case BodyKind::rod:
      return make_rod(scene, body);
  }
  throw Error(ErrorKind::internal, "a body is of no kind");
}

meshing::Skin load_skin(const Hdf5Reader& file) {
  meshing::Skin skin;
  skin.embedding = {file.int_vector("/embedding/element"), file.matrix("/embedding/weights")};
  if (file.has("/embedding/offset")) skin.offset = file.vector("/embedding/offset");
  if (file.has("/embedding/depth")) skin.depth = file.vector("/embedding/depth");
  return skin;
}

meshing::Outline placed_outline(const Scene& scene, const Value& body) {
  if (body["outline"]["type"].as_string() == "polyline") return {};
  meshing::Outline outline = meshing::make_outline(
      body["outline"], [&](const std::string& path) { return scene.resolve_path(path); });
  for (Points2& loop : outline.loops) place(body, loop);
  return outline;
}

std::vector<std::filesystem::path> shape_files(const Scene& scene, const Value& body) {
  std::vector<std::filesystem::path> files;
  if (body.has("mesh")) files.push_back(scene.resolve_path(body["mesh"].as_string()));
  if (!body.has("outline")) return files;
  for (const char* key : {"file", "font"}) {
    if (body["outline"].has(key)) files.push_back(scene.resolve_path(body["outline"][key].as_string()));
  }
  return files;
}

}  // namespace vivify::pipeline
