// A triangle surface. The sign comes from the angle-weighted pseudo-normal of the nearest feature (Bærentzen
// and Aanæs 2005), so it is right at edges and corners too.

#include <Eigen/Geometry>
#include <Eigen/StdVector>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <unsupported/Eigen/BVH>
#include <vector>

#include "common/error.h"
#include "sim/contact/closest_points.h"
#include "sim/contact/shapes/shapes.h"
#include "sim/contact/surface_check.h"

namespace vivify::sim {
namespace {

using Box3 = Eigen::AlignedBox<double, 3>;

struct NearestQuery {
  using Scalar = double;
  const TriangleMesh& surface;
  const Eigen::Vector3d point;
  int best_face = -1;
  TrianglePlace best = {};
  double best_distance2 = INFINITY;

  double minimumOnVolume(const Box3& box) const { return box.squaredExteriorDistance(point); }
  double minimumOnObject(int face) {
    const auto corner = [&](int k) -> Eigen::Vector3d {
      return surface.V.row(surface.F(face, k)).transpose();
    };
    const TrianglePlace candidate = nearest_on_triangle(point, corner(0), corner(1), corner(2));
    const double distance2 = (candidate.position - point).squaredNorm();
    if (distance2 < best_distance2 || (distance2 == best_distance2 && face < best_face)) {
      best_face = face;
      best = candidate;
      best_distance2 = distance2;
    }
    return distance2;
  }
};

// Vertices in the same place become one: assets split them where texture coordinates or parts meet.
void join_equal_vertices(TriangleMesh& surface) {
  std::map<std::array<double, 3>, int> first;
  std::vector<int> joined(static_cast<std::size_t>(surface.V.rows()));
  for (int v = 0; v < surface.V.rows(); ++v) {
    joined[v] = first.emplace(std::array{surface.V(v, 0), surface.V(v, 1), surface.V(v, 2)}, v).first->second;
  }
  for (Eigen::Index f = 0; f < surface.F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) surface.F(f, k) = joined[surface.F(f, k)];
  }
}

std::pair<int, int> edge_of(const Triangles& F, int face, int corner) {
  return std::minmax({F(face, corner), F(face, (corner + 1) % 3)});
}

class MeshShape final : public ColliderShape {
 public:
  MeshShape(const std::string& name, TriangleMesh surface) : surface_(std::move(surface)) {
    join_equal_vertices(surface_);
    const Triangles& F = surface_.F;
    if (F.rows() == 0) throw Error(ErrorKind::geometry, "collider '" + name + "' has no triangles");
    std::vector<int> faces;
    std::vector<Box3> boxes;
    check_collider_surface(name, surface_);
    corner_normals_.assign(static_cast<std::size_t>(surface_.V.rows()), Eigen::Vector3d::Zero());
    for (int f = 0; f < F.rows(); ++f) {
      std::array<Eigen::Vector3d, 3> corner;
      Box3 box;
      for (int k = 0; k < 3; ++k) {
        corner[k] = surface_.V.row(F(f, k)).transpose();
        box.extend(corner[k]);
      }
      const Eigen::Vector3d doubled = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
      const double length = doubled.norm();
      const Eigen::Vector3d normal = length > 0 ? Eigen::Vector3d(doubled / length) : Eigen::Vector3d::Zero();
      face_normals_.push_back(normal);
      if (length == 0) continue;  // degenerate faces have no inside; their neighbours carry the surface
      faces.push_back(f);
      boxes.push_back(box);
      for (int k = 0; k < 3; ++k) {
        corner_normals_[F(f, k)] +=
            corner_angle(corner[k], corner[(k + 1) % 3], corner[(k + 2) % 3]) * normal;
        const std::pair<int, int> edge = edge_of(F, f, k);
        const auto [it, inserted] = edge_normals_.try_emplace(edge, normal);
        if (inserted) {
          rim_edges_.insert(edge);
        } else {
          it->second += normal;
          rim_edges_.erase(edge);
        }
      }
    }
    if (faces.empty())
      throw Error(ErrorKind::geometry, "every triangle of collider '" + name + "' is degenerate");
    for (const auto& [a, b] : rim_edges_) rim_corners_.insert({a, b});
    hierarchy_ = Eigen::KdBVH<double, 3, int>(faces.begin(), faces.end(), boxes.begin(), boxes.end());
  }

  SurfacePoint nearest(const Eigen::Vector3d& point) const override {
    NearestQuery query{surface_, point};
    Eigen::BVMinimize(hierarchy_, query);
    const int f = query.best_face;
    if (f < 0) return {point, Eigen::Vector3d::UnitY(), NAN};  // from beyond all numbers
    const int feature = query.best.feature;
    Eigen::Vector3d pseudo_normal = face_normals_[f];
    bool rim = false;
    if (feature >= 4) {
      const std::pair<int, int> edge = edge_of(surface_.F, f, feature - 4);
      pseudo_normal = edge_normals_.at(edge);
      rim = rim_edges_.contains(edge);
    } else if (feature >= 1) {
      const int corner = surface_.F(f, feature - 1);
      pseudo_normal = corner_normals_[corner];
      rim = rim_corners_.contains(corner);
    }
    const Eigen::Vector3d offset = point - query.best.position;
    const double length = offset.norm();
    const double sign = !rim && offset.dot(pseudo_normal) < 0 ? -1 : 1;  // there is no inside beyond a rim
    // On a face the offset is along the face normal, which is exact even at distance zero.
    Eigen::Vector3d normal = face_normals_[f];
    if (feature != 0)
      normal = length > 1e-12 ? Eigen::Vector3d(sign * offset / length) : pseudo_normal.normalized();
    return {query.best.position, normal, sign * length};
  }

  TriangleMesh drawing() const override { return surface_; }

 private:
  TriangleMesh surface_;
  Eigen::KdBVH<double, 3, int> hierarchy_;
  std::vector<Eigen::Vector3d> face_normals_;                    // unit
  std::vector<Eigen::Vector3d> corner_normals_;                  // angle weighted, unit
  std::map<std::pair<int, int>, Eigen::Vector3d> edge_normals_;  // sum of the two face normals
  std::set<std::pair<int, int>> rim_edges_;                      // of one face only
  std::set<int> rim_corners_;
};

}  // namespace

std::unique_ptr<ColliderShape> make_mesh_shape(const std::string& name, TriangleMesh surface) {
  return std::make_unique<MeshShape>(name, std::move(surface));
}

}  // namespace vivify::sim
