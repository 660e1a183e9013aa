// render: one multi-layer EXR per frame.
#include "render/render.h"

#include <optional>

#include "common/hdf5_file.h"
#include "meshing/skin.h"
#include "pipeline/body_shape.h"
#include "pipeline/camera_path.h"
#include "pipeline/collider_settings.h"
#include "pipeline/content_key.h"
#include "pipeline/frame_range.h"
#include "pipeline/looks.h"
#include "pipeline/placement.h"
#include "pipeline/stages/stages.h"
#include "render/scene.h"

namespace vivify::pipeline {
namespace {

constexpr long kUnitsPerFrame = 100;

bool is_drawn(const Value& item) { return !item.has("visible") || item["visible"].as_bool(); }

// Colliders or props that are drawn.
std::vector<Value> drawn_objects(const Scene& scene, const std::string& list) {
  std::vector<Value> objects;
  for (const Value& item : scene.settings[list].items()) {
    if (is_drawn(item)) objects.push_back(item);
  }
  return objects;
}

// Everything that a picture depends on, but for its number.
std::string looks_key(const Job& job) {
  const Scene& scene = job.scene;
  ContentKey key("render");
  key.add("simulation", simulation_key(job));
  for (const char* part : {"camera", "render"}) key.add(part, scene.settings[part]);
  const render::Looks looks = scene_looks(scene);
  for (const auto& [name, material] : looks.materials) key.add(name, material);
  for (const Value& light : looks.lights) key.add("light", light);
  // The smoothed path of the camera depends on the frames to come.
  if (scene.settings["camera"].has("follow")) key.add("frames", scene.frame_count);
  for (const Value& body : scene.settings["bodies"].items()) key.add("looks", body["looks"]);
  for (const Value& collider : drawn_objects(scene, "colliders")) {
    key.add("looks", collider["looks"]);
    add_collider_geometry(key, scene, collider);
  }
  for (const Value& prop : drawn_objects(scene, "props")) {
    for (const char* part : {"position", "scale", "heading_deg", "looks"}) key.add(part, prop[part]);
    key.add_mesh_file(scene.resolve_path(prop["mesh"].as_string()));
  }
  for (const std::filesystem::path& file : render::referenced_files(looks)) key.add_file(file);
  return key.hex();
}

std::vector<Product> products(const Job& job) {
  const std::vector<std::string> keys = frame_keys(job);
  std::vector<Product> products;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    products.push_back({picture_file(job.scene, job.frames[i]), keys[i], kUnitsPerFrame});
  }
  return products;
}

// A body as drawn: its surface moves with the simulation mesh.
struct DrawnBody {
  std::string name;
  render::Mesh mesh;
  meshing::Skin skin;
  RowMatrixXi elements;
};

DrawnBody load_body(const Job& job, const Value& body, const render::Looks& looks) {
  const Hdf5Reader file(job.out / mesh_file(body));
  DrawnBody drawn;
  drawn.name = body["name"].as_string();
  drawn.elements = file.int_matrix("/elements");
  drawn.skin = load_skin(file);
  drawn.mesh.name = drawn.name;
  drawn.mesh.F = file.int_matrix("/surface/F");
  if (file.has("/surface/UV")) drawn.mesh.UV = file.matrix("/surface/UV");
  if (file.has("/surface/face_part")) drawn.mesh.face_part = file.int_vector("/surface/face_part");
  std::vector<std::string> part_names;
  if (file.has("/surface/part_names")) part_names = file.texts("/surface/part_names");
  drawn.mesh.part_materials = part_materials(body, part_names, looks);
  return drawn;
}

render::Mesh drawn_mesh(const Value& object, TriangleMesh surface, const render::Looks& looks) {
  render::Mesh mesh;
  mesh.name = object["name"].as_string();
  mesh.part_materials = part_materials(object, surface.part_names, looks);
  mesh.V = std::move(surface.V);
  mesh.F = std::move(surface.F);
  mesh.UV = std::move(surface.UV);
  mesh.face_part = std::move(surface.face_part);
  return mesh;
}

// A collider on its way.
struct MovingObject {
  std::size_t mesh;  // of the frame
  Points V;          // in its own frame
  sim::RigidPath path;

  Points at(double t) const {
    const Eigen::Isometry3d pose = path.pose(t);
    return (V * pose.linear().transpose()).rowwise() + pose.translation().transpose();
  }
};

// Positions of the vertices of a body's simulation mesh (#V by 2 or 3); none before it appears.
std::optional<RowMatrixXd> body_positions(const Job& job, int frame, const std::string& body) {
  const Hdf5Reader state(job.out / simulation_file(frame));
  const std::string x = "/bodies/" + body + "/x";
  return state.has(x) ? std::optional(state.matrix(x)) : std::nullopt;
}

void make(const Job& job, const std::vector<Product>& missing, Ledger& ledger, Progress& progress) {
  const Scene& scene = job.scene;
  const render::Looks looks = scene_looks(scene);
  render::Frame frame;
  std::vector<DrawnBody> bodies;
  for (const Value& body : scene.settings["bodies"].items()) bodies.push_back(load_body(job, body, looks));
  frame.meshes.resize(bodies.size());
  std::vector<MovingObject> moving;
  for (const Value& collider : drawn_objects(scene, "colliders")) {
    frame.meshes.push_back(drawn_mesh(collider, collider_surface(scene, collider), looks));
    sim::RigidPath path = collider_path(collider, collider["name"].as_string());
    if (path.moves()) {
      moving.push_back({frame.meshes.size() - 1, frame.meshes.back().V, std::move(path)});
    }
  }
  for (const Value& prop : drawn_objects(scene, "props")) {
    frame.meshes.push_back(drawn_mesh(prop, read_placed_mesh(scene, prop), looks));
  }
  for (std::size_t i = 0; i < frame.meshes.size(); ++i) {
    render::Mesh& mesh = i < bodies.size() ? bodies[i].mesh : frame.meshes[i];
    mesh.object_id = static_cast<int>(i) + 1;
  }

  const render::Renderer renderer(looks);
  const render::RenderSettings settings = render::make_settings(scene.settings["render"]);
  const std::vector<render::Camera> cameras = frame_cameras(scene.settings, job.out, scene.frame_count);

  auto product = missing.begin();
  for (const int number : job.frames) {
    if (product == missing.end()) break;
    if (picture_file(scene, number) != product->file) continue;
    frame.number = number;
    frame.camera = cameras[static_cast<std::size_t>(number - 1)];
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const std::optional<RowMatrixXd> x = body_positions(job, number, bodies[i].name);
      frame.meshes[i] = x ? bodies[i].mesh : render::Mesh();
      if (x) frame.meshes[i].V = meshing::draw(bodies[i].skin, bodies[i].elements, *x);
    }
    for (const MovingObject& object : moving) {
      frame.meshes[object.mesh].V = object.at(static_cast<double>(number - 1) / scene.fps);
    }
    const std::string note = "frame " + std::to_string(number);
    long shown = 0;
    const render::Film film = renderer.render(frame, settings, [&](double share) {
      const long reached = std::min(static_cast<long>(share * kUnitsPerFrame), kUnitsPerFrame - 1);
      if (reached > shown) progress.advance(reached - shown, note);
      shown = std::max(shown, reached);
    });
    ledger.commit(product->file, product->key, render::encode_exr(film));
    progress.advance(kUnitsPerFrame - shown, note);
    ++product;
  }
}

}  // namespace

std::vector<std::string> frame_keys(const Job& job) {
  const std::string base = looks_key(job);
  std::vector<std::string> keys;
  for (const int frame : job.frames) keys.push_back(Hasher().add(base).add(std::to_string(frame)).hex());
  return keys;
}

std::string picture_file(const Scene& scene, int frame) {
  return "render/" + scene.name + "." + frame_text(frame) + ".exr";
}

Stage render_stage() { return {"render", "Everything up to the pictures (EXR)", products, make, true}; }

}  // namespace vivify::pipeline
