// mesh: for each body the simulation mesh, made from its repaired surface, and the drawn surface embedded in
// it.
#include "common/error.h"
#include "common/hdf5_file.h"
#include "common/log.h"
#include "common/stop.h"
#include "meshing/embedding.h"
#include "meshing/repair.h"
#include "meshing/tetrahedralize.h"
#include "pipeline/content_key.h"
#include "pipeline/placement.h"
#include "pipeline/stages/stages.h"
#include "sim/elastic/models.h"

namespace vivify::pipeline {
namespace {

// A point this far outside its tetrahedron exaggerates the motion (meshing/embedding.h).
constexpr double kFarOutside = 2;

std::vector<Product> products(const Job& job) {
  std::vector<Product> products;
  for (const Value& body : job.scene.settings["bodies"].items()) {
    products.push_back({mesh_file(body), mesh_key(job, body)});
  }
  return products;
}

Bytes make_body(const Scene& scene, const Value& body) {
  const std::string& name = body["name"].as_string();
  const TriangleMesh surface = read_placed_mesh(scene, body);
  part_materials(body, surface.part_names);  // wrong part names are told before the long work

  const meshing::RepairedSurface repaired = meshing::repair_surface(surface);
  for (const std::string& note : repaired.notes) log_info(name + ": " + note);
  const meshing::TetrahedralizeResult result =
      meshing::tetrahedralize(repaired.mesh, meshing::tetrahedra_settings(body["tetrahedra"]));
  for (const std::string& note : result.notes) log_info(name + ": " + note);
  const TetMesh& mesh = result.mesh;
  const meshing::Embedding embedding = meshing::embed(mesh, surface.V);
  if (embedding.largest_weight() > kFarOutside) {
    log_warning(
        name +
        ": parts of the drawn surface lie far outside the simulation mesh and will exaggerate its motion; "
        "raise tetrahedra.vertices");
  }

  Hdf5Writer file;
  file.put_attribute("schema_version", 1);
  file.put("/X0", RowMatrixXd(mesh.V));
  file.put("/elements", RowMatrixXi(mesh.T));
  file.put("/mass", sim::build_model(sim_mesh(mesh), sim::RestLayout::compatible, body["model"]).mass);
  file.put("/surface/V", RowMatrixXd(surface.V));
  file.put("/surface/F", RowMatrixXi(surface.F));
  if (surface.UV.rows() > 0) file.put("/surface/UV", RowMatrixXd(surface.UV));
  if (surface.face_part.size() > 0) file.put("/surface/face_part", surface.face_part);
  if (!surface.part_names.empty()) file.put("/surface/part_names", surface.part_names);
  file.put("/embedding/tet", embedding.element);
  file.put("/embedding/weights", RowMatrixXd(embedding.weights));
  file.put("/repaired/V", RowMatrixXd(repaired.mesh.V));
  file.put("/repaired/F", RowMatrixXi(repaired.mesh.F));
  file.put("/repaired/route", repaired.route);
  std::vector<std::string> notes = repaired.notes;
  notes.insert(notes.end(), result.notes.begin(), result.notes.end());
  if (!notes.empty()) file.put("/notes", notes);
  return file.image();
}

void make(const Job& job, const std::vector<Product>& missing, Ledger& ledger, Progress& progress) {
  auto product = missing.begin();
  for (const Value& body : job.scene.settings["bodies"].items()) {
    if (product == missing.end()) break;
    if (mesh_file(body) != product->file) continue;
    check_stop();
    try {
      ledger.commit(product->file, product->key, make_body(job.scene, body));
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::geometry || !error.where().file.empty()) throw;
      throw Error(error.kind(), body["name"].as_string() + ": " + error.what(), error.hint(),
                  body["mesh"].where());
    }
    progress.advance(1, body["name"].as_string());
    ++product;
  }
}

}  // namespace

std::string mesh_key(const Job& job, const Value& body) {
  ContentKey key("meshing");
  for (const char* part : {"position", "scale", "heading_deg", "tetrahedra"}) key.add(part, body[part]);
  key.add("model", body["model"]);
  key.add_file(job.scene.resolve_path(body["mesh"].as_string()));
  return key.hex();
}

std::string mesh_file(const Value& body) { return "mesh/" + body["name"].as_string() + ".h5"; }

Stage mesh_stage() { return {"mesh", "The simulation meshes", products, make}; }

}  // namespace vivify::pipeline
