// weights: for each body its cage, and the harmonic coordinates of the simulation mesh in it.
#include "common/error.h"
#include "common/hdf5_file.h"
#include "common/log.h"
#include "common/mesh_io.h"
#include "common/stop.h"
#include "common/text.h"
#include "meshing/cage.h"
#include "meshing/harmonic.h"
#include "pipeline/content_key.h"
#include "pipeline/placement.h"
#include "pipeline/stages/stages.h"

namespace vivify::pipeline {
namespace {

std::vector<Product> products(const Job& job) {
  std::vector<Product> products;
  for (const Value& body : job.scene.settings["bodies"].items()) {
    products.push_back({weights_file(body), weights_key(job, body)});
  }
  return products;
}

// The cage of a body, in the world. A cage from a file is placed like the body's mesh.
TriangleMesh make_body_cage(const Job& job, const Value& body, const Hdf5Reader& mesh) {
  const Value& space = body["rest_space"];
  const Points rest = mesh.matrix("/X0");
  if (!space.has("file")) {
    TriangleMesh surface;
    surface.V = mesh.matrix("/repaired/V");
    surface.F = mesh.int_matrix("/repaired/F");
    return meshing::make_cage(rest, surface, meshing::cage_settings(space));
  }
  TriangleMesh cage = read_mesh(job.scene.resolve_path(space["file"].as_string()));
  place(body, cage.V);
  return meshing::validate_cage(std::move(cage), rest, 0, "the cage " + space["file"].as_string());
}

Bytes make_body(const Job& job, const Value& body) {
  const Hdf5Reader mesh(job.out / mesh_file(body));
  const TriangleMesh cage = make_body_cage(job, body, mesh);
  const int unknowns = static_cast<int>(body["rest_space"]["harmonic_unknowns"].as_integer());
  meshing::HarmonicReport report;
  const Eigen::MatrixXd weights =
      meshing::harmonic_coordinates(cage, mesh.matrix("/X0"), {unknowns}, &report);
  if (report.projected > 0) {
    log_info(body["name"].as_string() + ": " + std::to_string(report.projected) +
             " vertices had slightly negative cage weights (down to " + number_text(report.most_negative) +
             "), which were projected");
  }
  Hdf5Writer file;
  file.put_attribute("schema_version", 1);
  file.put("/space", body["rest_space"]["type"].as_string());
  file.put("/weights", RowMatrixXd(weights));
  file.put("/cage/V", RowMatrixXd(cage.V));
  file.put("/cage/F", RowMatrixXi(cage.F));
  return file.image();
}

void make(const Job& job, const std::vector<Product>& missing, Ledger& ledger, Progress& progress) {
  auto product = missing.begin();
  for (const Value& body : job.scene.settings["bodies"].items()) {
    if (product == missing.end()) break;
    if (weights_file(body) != product->file) continue;
    check_stop();
    try {
      ledger.commit(product->file, product->key, make_body(job, body));
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::geometry && error.kind() != ErrorKind::numerical) throw;
      const Value& file = body["rest_space"]["file"];
      throw Error(error.kind(), body["name"].as_string() + ": " + error.what(), error.hint(),
                  file.is_null() ? body["rest_space"].where() : file.where());
    }
    progress.advance(1, body["name"].as_string());
    ++product;
  }
}

}  // namespace

std::string weights_key(const Job& job, const Value& body) {
  ContentKey key("meshing");
  key.add("mesh", mesh_key(job, body)).add("rest_space", body["rest_space"]);
  if (body["rest_space"].has("file"))
    key.add_file(job.scene.resolve_path(body["rest_space"]["file"].as_string()));
  return key.hex();
}

std::string weights_file(const Value& body) { return "weights/" + body["name"].as_string() + ".h5"; }

Stage weights_stage() { return {"weights", "Everything up to the cage weights", products, make}; }

}  // namespace vivify::pipeline
