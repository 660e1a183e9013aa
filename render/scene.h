// What the renderer is given: looks (materials and lights, the same for a whole video) and frames (camera and
// meshes). Plain data and the schemas of the scene file that describe it. Metres, +Y up, linear Rec. 709
// colours.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/mesh.h"
#include "common/schema.h"
#include "common/value.h"

namespace vivify::render {

Schema material_schema();  // one material: a variant by `type`, from the registry in materials/
Schema light_schema();     // one light: a variant by `type`, from the registry in lights/
Schema camera_schema();    // the camera; `follow` is the name of a body and is left to the caller
Schema render_schema();    // size, spp, depth, seed, clamp

// A surface to draw.
struct Mesh {
  std::string name;                         // for messages
  Points V;                                 // #V by 3
  Triangles F;                              // #F by 3, counter-clockwise is outward
  TexCoords UV;                             // #V by 2, or empty; v = 0 is the bottom row of an image
  Eigen::VectorXi face_part;                // #F, index into part_materials; empty: all faces are part 0
  std::vector<std::string> part_materials;  // name of the material of each part
  int object_id = 0;   // written to the `id` layer; 0 is the background, so bodies count from 1
  bool smooth = true;  // shading normals interpolated over edges below crease_deg
  double crease_deg = 40;
};

// A thin lens. Everything in front of the plane at `focus_m` is drawn up to infinity.
struct Camera {
  Eigen::Vector3d position = {0, 1, 5};
  Eigen::Vector3d target = {0, 0, 0};
  Eigen::Vector3d up = {0, 1, 0};
  double fov_deg = 35;           // vertical angle of view
  double aperture_radius_m = 0;  // radius of the lens; 0 is a pinhole
  double focus_m = 0;  // distance of the plane in focus along the view axis; 0: the distance of the target
};

// The camera of a value resolved with camera_schema().
Camera make_camera(const Value& value);

// Materials by name and lights, as resolved with material_schema() and light_schema().
struct Looks {
  std::map<std::string, Value> materials;
  std::vector<Value> lights;
  std::filesystem::path folder;  // relative paths of textures start here
};

// Files that the looks refer to (textures, environment images), in a fixed order; for cache keys.
std::vector<std::filesystem::path> referenced_files(const Looks& looks);

struct Frame {
  int number = 1;  // gives every frame its own noise
  Camera camera;
  std::vector<Mesh> meshes;
};

struct RenderSettings {
  // How light is found. All three have the same mean; the last two are for tests.
  enum class Strategy { mis, lights_only, bsdf_only };

  int width = 480;
  int height = 270;
  int spp = 8;        // samples per pixel; powers of two are best
  int splits = 4;     // paths that go on from the first rough surface of a sample
  int max_depth = 6;  // surfaces that scatter a path at most
  std::uint64_t seed = 0;
  double clamp = 0;  // largest luminance of one indirect contribution; 0 is off and unbiased
  // Least roughness of surfaces that light meets on its way to a matt one; 0 is off and unbiased. Mirrored
  // light is spread out there instead of making specks; none is lost.
  double indirect_roughness = 0;
  Strategy strategy = Strategy::mis;
};

// The settings of a value resolved with render_schema(). Throws Error(usage) for more than 2^28 pixels.
RenderSettings make_settings(const Value& value);

// A named quality: draft, preview (the default of the schema) or final.
struct QualityPreset {
  std::string name;
  int width;
  int height;
  int spp;
  int splits;
};
const std::vector<QualityPreset>& quality_presets();

// The preset as assignments for apply_override: {"render.size=[1280, 720]", "render.spp=64",
// "render.splits=1"}. Throws Error(usage) for an unknown name.
std::vector<std::string> quality_overrides(const std::string& name);

}  // namespace vivify::render
