// weights: for each body what its rest space is made of: a cage with the harmonic coordinates of the
// simulation mesh in it, or example poses.
#include "common/error.h"
#include "common/hdf5_file.h"
#include "common/log.h"
#include "common/mesh_io.h"
#include "common/stop.h"
#include "common/text.h"
#include "meshing/cage.h"
#include "meshing/harmonic.h"
#include "meshing/planar_cage.h"
#include "meshing/planar_harmonic.h"
#include "pipeline/body_settings.h"
#include "pipeline/body_shape.h"
#include "pipeline/content_key.h"
#include "pipeline/example_pose.h"
#include "pipeline/placement.h"
#include "pipeline/stages/stages.h"
#include "pipeline/version.h"

namespace vivify::pipeline {
namespace {

std::vector<Product> products(const Job& job) {
  std::vector<Product> products;
  for (const Value& body : job.scene.settings["bodies"].items()) {
    products.push_back({weights_file(body), weights_key(job, body)});
  }
  return products;
}

// The cage of a body of space, in the world. A cage from a file is placed like the body's mesh.
TriangleMesh make_space_cage(const Job& job, const Value& body, const Hdf5Reader& mesh) {
  const Value& space = body["rest_space"];
  const Points rest = mesh.matrix("/X0");
  if (!space.has("file")) {
    const std::string surface_group = mesh.has("/repaired/V") ? "/repaired" : "/surface";
    TriangleMesh surface;
    surface.V = mesh.matrix(surface_group + "/V");
    surface.F = mesh.int_matrix(surface_group + "/F");
    return meshing::make_cage(rest, surface, meshing::cage_settings(space));
  }
  TriangleMesh cage = read_mesh(job.scene.resolve_path(space["file"].as_string()));
  place(body, cage.V);
  return meshing::validate_cage(std::move(cage), rest, 0, "the cage " + space["file"].as_string());
}

// The cage of a body of the plane, in the world.
Points2 make_planar_cage(const Job& job, const Value& body, const Points2& rest) {
  const Value& space = body["rest_space"];
  const std::vector<Value>& corners = space["points"].items();
  if (corners.empty()) {
    return meshing::make_planar_cage(rest, placed_outline(job.scene, body), meshing::cage_settings(space));
  }
  Points2 cage(std::ssize(corners), 2);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    cage.row(static_cast<Eigen::Index>(i)) = corners[i].as_vector().transpose();
  }
  place(body, cage);
  return meshing::validate_planar_cage(std::move(cage), rest);
}

void put_cage(const Job& job, const Value& body, const Hdf5Reader& mesh, Hdf5Writer& file) {
  const meshing::HarmonicSettings settings = {
      static_cast<int>(body["rest_space"]["harmonic_unknowns"].as_integer())};
  meshing::HarmonicReport report;
  Eigen::MatrixXd weights;
  if (is_planar(body_kind(body))) {
    const Points2 rest = mesh.matrix("/X0");
    const Points2 cage = make_planar_cage(job, body, rest);
    weights = meshing::harmonic_coordinates(cage, rest, settings, &report);
    file.put("/cage/V", RowMatrixXd(cage));
  } else {
    const TriangleMesh cage = make_space_cage(job, body, mesh);
    weights = meshing::harmonic_coordinates(cage, mesh.matrix("/X0"), settings, &report);
    file.put("/cage/V", RowMatrixXd(cage.V));
    file.put("/cage/F", RowMatrixXi(cage.F));
  }
  if (report.projected > 0) {
    log_info(body["name"].as_string() + ": " + std::to_string(report.projected) +
             " vertices had slightly negative cage weights (down to " + number_text(report.most_negative) +
             "), which were projected");
  }
  file.put("/weights", RowMatrixXd(weights));
}

void put_examples(const Job& job, const Value& body, const Hdf5Reader& mesh, Hdf5Writer& file) {
  const SimMesh rest = {mesh.matrix("/X0"), mesh.int_matrix("/elements")};
  std::vector<std::string> names, groups;
  for (const Value& example : examples_of(body)) {
    const RowMatrixXd pose = example_pose(job.scene, body, example, rest);
    file.put("/examples/" + std::to_string(names.size()) + "/V", pose);
    names.push_back(example_name(example));
    groups.push_back(example.has("group") ? example["group"].as_string() : "");
  }
  file.put("/examples/names", names);
  file.put("/examples/groups", groups);
}

Bytes make_body(const Job& job, const Value& body) {
  const Hdf5Reader mesh(job.out / mesh_file(body));
  const std::string& space = body["rest_space"]["type"].as_string();
  Hdf5Writer file;
  file.put_attribute("schema_version", 2);
  file.put("/space", space);
  if (space == "cage") put_cage(job, body, mesh, file);
  if (!examples_of(body).empty()) put_examples(job, body, mesh, file);
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
      const bool of_geometry = error.kind() == ErrorKind::geometry || error.kind() == ErrorKind::numerical;
      if (!of_geometry || !error.where().file.empty()) throw;
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
  const Value& space = body["rest_space"];
  key.add("mesh", mesh_key(job, body)).add("rest_space", space);
  if (space.has("file")) key.add_mesh_file(job.scene.resolve_path(space["file"].as_string()));
  for (const Value& example : examples_of(body)) {
    if (example.has("file")) {
      key.add_mesh_file(job.scene.resolve_path(example["file"].as_string()));
    } else {
      key.add("sim", source_revision("sim")).add("gravity", job.scene.settings["gravity"]);
      key.add_file(job.scene.resolve_path(example["pose"].as_string()));
    }
  }
  return key.hex();
}

std::string weights_file(const Value& body) { return "weights/" + body["name"].as_string() + ".h5"; }

Stage weights_stage() { return {"weights", "Everything up to the rest spaces", products, make}; }

}  // namespace vivify::pipeline
