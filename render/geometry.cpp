#include "render/geometry.h"

#include <algorithm>
#include <cmath>

#include "common/text.h"
#include "render/normals.h"

namespace vivify::render {
namespace {

std::string quoted(const std::string& name) { return "'" + name + "'"; }

[[noreturn]] void bad_mesh(const Mesh& mesh, const std::string& what) {
  throw Error(ErrorKind::geometry, "mesh " + quoted(mesh.name) + " cannot be drawn: " + what);
}

std::vector<std::uint32_t> materials_of_parts(const Mesh& mesh,
                                              const std::map<std::string, std::uint32_t>& material_index) {
  std::vector<std::uint32_t> materials;
  for (const std::string& name : mesh.part_materials) {
    const auto found = material_index.find(name);
    if (found == material_index.end()) {
      std::vector<std::string> names;
      for (const auto& [known, index] : material_index) names.push_back(known);
      const std::string nearest = nearest_word(name, names);
      throw Error(ErrorKind::usage, "mesh " + quoted(mesh.name) + " uses an unknown material " + quoted(name),
                  nearest.empty() ? "add it under `materials`" : "did you mean " + quoted(nearest) + "?");
    }
    materials.push_back(found->second);
  }
  return materials;
}

}  // namespace

Geometry::Geometry(const std::vector<Mesh>& meshes,
                   const std::map<std::string, std::uint32_t>& material_index) {
  for (const Mesh& mesh : meshes) add(mesh, material_index);
}

void Geometry::add(const Mesh& mesh, const std::map<std::string, std::uint32_t>& material_index) {
  const std::vector<std::uint32_t> materials = materials_of_parts(mesh, material_index);
  const bool has_uv = mesh.UV.rows() > 0;
  if (has_uv && mesh.UV.rows() != mesh.V.rows())
    bad_mesh(mesh, "it needs one texture coordinate for each point");
  if (mesh.face_part.size() > 0 && mesh.face_part.size() != mesh.F.rows()) {
    bad_mesh(mesh, "it needs one part for each triangle");
  }
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  const auto base = static_cast<std::uint32_t>(points_.size());
  const auto to_float = [](double v) { return static_cast<float>(v); };
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
    points.push_back({to_float(mesh.V(i, 0)), to_float(mesh.V(i, 1)), to_float(mesh.V(i, 2))});
    if (!is_finite(points.back())) bad_mesh(mesh, "point " + std::to_string(i) + " is not finite");
    uv_.push_back(has_uv ? Vec2{to_float(mesh.UV(i, 0)), to_float(mesh.UV(i, 1))} : Vec2{});
  }
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    std::array<std::uint32_t, 3> t;
    for (int k = 0; k < 3; ++k) {
      const int index = mesh.F(f, k);
      if (index < 0 || index >= mesh.V.rows()) {
        bad_mesh(mesh, "triangle " + std::to_string(f) + " refers to point " + std::to_string(index));
      }
      t[static_cast<std::size_t>(k)] = static_cast<std::uint32_t>(index);
    }
    triangles.push_back(t);
    const int part = mesh.face_part.size() > 0 ? mesh.face_part[f] : 0;
    if (part < 0 || part >= static_cast<int>(materials.size())) {
      bad_mesh(mesh, "part " + std::to_string(part) + " has no material");
    }
    material_.push_back(materials[static_cast<std::size_t>(part)]);
    object_.push_back(mesh.object_id);
    const Vec3 n = cross(points[t[1]] - points[t[0]], points[t[2]] - points[t[0]]);
    const Vec2 a = uv_[base + t[0]], b = uv_[base + t[1]], c = uv_[base + t[2]];
    const float uv_area = std::abs((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y));
    uv_scale_.push_back(length2(n) > 0 ? std::sqrt(uv_area / length(n)) : 0);
  }
  if (mesh.smooth) {
    const auto crease = static_cast<float>(mesh.crease_deg * (3.14159265358979323846 / 180));
    const std::vector<Vec3> normals = corner_normals(points, triangles, crease);
    normals_.insert(normals_.end(), normals.begin(), normals.end());
  } else {
    normals_.resize(normals_.size() + 3 * triangles.size());
  }
  points_.insert(points_.end(), points.begin(), points.end());
  for (const auto& t : triangles) triangles_.push_back({t[0] + base, t[1] + base, t[2] + base});
}

Surface Geometry::surface(const Hit& hit, const Ray& ray) const {
  const auto& t = triangles_[hit.triangle];
  const Vec3& a = points_[t[0]];
  const Vec3& b = points_[t[1]];
  const Vec3& c = points_[t[2]];
  const float w = 1 - hit.u - hit.v;
  const Vec3 wo = -ray.direction;
  Surface s;
  s.triangle = hit.triangle;
  s.position = a * w + b * hit.u + c * hit.v;
  s.lifted = s.position;
  s.geometric = normalize(cross(b - a, c - a));
  s.front = dot(s.geometric, wo) >= 0;
  if (!s.front) s.geometric = -s.geometric;
  s.shading = s.geometric;
  const Vec3* n = &normals_[3 * static_cast<std::size_t>(hit.triangle)];
  if (!is_zero(n[0])) {
    const float side = s.front ? 1.0f : -1.0f;
    const Vec3 smooth = (n[0] * w + n[1] * hit.u + n[2] * hit.v) * side;
    if (length2(smooth) > 1e-12f && dot(smooth, s.geometric) > 0) {
      s.shading = normalize(smooth);
      // A normal that looks away from the ray is turned back just into view.
      constexpr float kLeast = 1e-3f;
      const float cosine = dot(s.shading, wo);
      if (cosine < kLeast) s.shading = normalize(s.shading + wo * (kLeast - cosine));
      const auto lift = [&](const Vec3& corner, const Vec3& normal) {
        return normal * -std::min(0.0f, dot(s.position - corner, normal));
      };
      s.lifted += lift(a, n[0] * side) * w + lift(b, n[1] * side) * hit.u + lift(c, n[2] * side) * hit.v;
    }
  }
  const Vec2 &ta = uv_[t[0]], &tb = uv_[t[1]], &tc = uv_[t[2]];
  s.uv = {ta.x * w + tb.x * hit.u + tc.x * hit.v, ta.y * w + tb.y * hit.u + tc.y * hit.v};
  s.uv_scale = uv_scale_[hit.triangle];
  return s;
}

Vec3 offset_from_surface(const Vec3& point, const Vec3& normal) {
  // The point is a sum of corners, so it is off by a few roundings of its largest coordinate; 32 of them are
  // safe.
  const float scale = std::max({std::abs(point.x), std::abs(point.y), std::abs(point.z), 0.0625f});
  return point + normal * (scale * (32 * 0x1p-24f));
}

}  // namespace vivify::render
