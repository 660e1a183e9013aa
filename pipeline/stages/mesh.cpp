// mesh: for each body the simulation mesh and the drawn surface that moves with it.
#include "common/error.h"
#include "common/hdf5_file.h"
#include "common/stop.h"
#include "meshing/contact_surface.h"
#include "pipeline/body_settings.h"
#include "pipeline/body_shape.h"
#include "pipeline/content_key.h"
#include "pipeline/stages/stages.h"
#include "sim/elastic/models.h"

namespace vivify::pipeline {
namespace {

std::vector<Product> products(const Job& job) {
  std::vector<Product> products;
  for (const Value& body : job.scene.settings["bodies"].items()) {
    products.push_back({mesh_file(body), mesh_key(job, body)});
  }
  return products;
}

// The surface with which a solid touches other bodies; rods and shells touch with themselves.
void put_contact_surface(const Scene& scene, const Value& body, const BodyShape& shape, Hdf5Writer& file) {
  const BodyKind kind = body_kind(body);
  const auto points = static_cast<int>(body["contact"]["points"].as_integer());
  meshing::CoarseSurface coarse;
  if (kind == BodyKind::flat) {
    coarse = meshing::coarse_contact_outline(placed_outline(scene, body), shape.mesh.V, shape.mesh.E, points);
  } else if (kind == BodyKind::solid && shape.closed.V.rows() > 0) {
    coarse = meshing::coarse_contact_surface(shape.closed, {shape.mesh.V, shape.mesh.E}, points);
  } else {
    return;
  }
  file.put("/contact/V", coarse.V);
  file.put("/contact/F", coarse.F);
  file.put("/contact/element", coarse.embedding.element);
  file.put("/contact/weights", coarse.embedding.weights);
  file.put("/contact/deviation", coarse.deviation);
}

Bytes make_body(const Scene& scene, const Value& body) {
  const BodyShape shape = make_body_shape(scene, body);
  const auto& [embedding, offset, depth] = shape.skin;
  Hdf5Writer file;
  file.put_attribute("schema_version", 2);
  file.put("/X0", shape.mesh.V);
  file.put("/elements", shape.mesh.E);
  file.put("/mass", sim::build_model(shape.mesh, sim::RestLayout::compatible, body["model"]).mass);
  file.put("/surface/V", RowMatrixXd(shape.surface.V));
  file.put("/surface/F", RowMatrixXi(shape.surface.F));
  if (shape.surface.UV.rows() > 0) file.put("/surface/UV", RowMatrixXd(shape.surface.UV));
  if (shape.surface.face_part.size() > 0) file.put("/surface/face_part", shape.surface.face_part);
  if (!shape.surface.part_names.empty()) file.put("/surface/part_names", shape.surface.part_names);
  file.put("/embedding/element", embedding.element);
  file.put("/embedding/weights", embedding.weights);
  if (offset.size() > 0) file.put("/embedding/offset", offset);
  if (depth.size() > 0) file.put("/embedding/depth", depth);
  if (shape.closed.V.rows() > 0) {
    file.put("/repaired/V", RowMatrixXd(shape.closed.V));
    file.put("/repaired/F", RowMatrixXi(shape.closed.F));
    file.put("/repaired/route", shape.route);
  }
  put_contact_surface(scene, body, shape, file);
  if (!shape.notes.empty()) file.put("/notes", shape.notes);
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
                  shape_of(body).where());
    }
    progress.advance(1, body["name"].as_string());
    ++product;
  }
}

}  // namespace

std::string mesh_key(const Job& job, const Value& body) {
  ContentKey key("meshing");
  for (const char* part : {"outline", "extrude", "position", "scale", "heading_deg", "tetrahedra",
                           "triangles", "edges", "model"}) {
    key.add(part, body[part]);
  }
  key.add("contact.points", body["contact"]["points"]);
  for (const std::filesystem::path& file : shape_files(job.scene, body)) key.add_mesh_file(file);
  return key.hex();
}

std::string mesh_file(const Value& body) { return "mesh/" + body["name"].as_string() + ".h5"; }

Stage mesh_stage() { return {"mesh", "The simulation meshes", products, make}; }

}  // namespace vivify::pipeline
