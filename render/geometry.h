// All triangles of a frame in flat arrays, and the surface at a hit.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "render/accel.h"
#include "render/scene.h"
#include "render/vec.h"

namespace vivify::render {

// A point of a surface as seen by a ray. All normals are on the ray's side.
struct Surface {
  std::uint32_t triangle;
  Vec3 position;
  Vec3 lifted;  // the position moved out to the smooth surface [Hanika 2021]: where reflected and shadow rays
                // start
  Vec3 geometric;  // of the triangle
  Vec3 shading;    // interpolated, less than 90° from the ray
  bool front;      // the ray met the outer side
  Vec2 uv;
  float uv_scale;  // texture coordinates per metre
};

class Geometry {
 public:
  // `material_index` gives the index of each material by name. Throws Error(usage) for a material that is not
  // there and Error(geometry) for indices out of range, points that are not finite, or arrays that do not
  // fit.
  Geometry(const std::vector<Mesh>& meshes, const std::map<std::string, std::uint32_t>& material_index);

  const std::vector<Vec3>& points() const { return points_; }
  const std::vector<std::array<std::uint32_t, 3>>& triangles() const { return triangles_; }
  std::uint32_t material(std::uint32_t triangle) const { return material_[triangle]; }
  int object(std::uint32_t triangle) const { return object_[triangle]; }

  Surface surface(const Hit& hit, const Ray& ray) const;

 private:
  void add(const Mesh& mesh, const std::map<std::string, std::uint32_t>& material_index);

  std::vector<Vec3> points_;
  std::vector<Vec2> uv_;  // by point
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<Vec3> normals_;    // 3 by triangle; zero for flat triangles
  std::vector<float> uv_scale_;  // by triangle
  std::vector<std::uint32_t> material_;
  std::vector<int> object_;
};

// `point` moved off the surface by a few units of rounding, to the side of `normal`.
Vec3 offset_from_surface(const Vec3& point, const Vec3& normal);

}  // namespace vivify::render
