// A triangle surface. The sign comes from the angle-weighted pseudo-normal of the nearest feature (Bærentzen
// and Aanæs 2005), so it is right at edges and corners too.

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "common/error.h"
#include "sim/contact/broad_phase.h"
#include "sim/contact/closest_points.h"
#include "sim/contact/shapes/shapes.h"
#include "sim/contact/surface_check.h"

namespace vivify::sim {
namespace {

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

std::pair<int, int> edge_of(const RowMatrixXi& F, int face, int corner) {
  return std::minmax({F(face, corner), F(face, (corner + 1) % 3)});
}

class MeshShape final : public ColliderShape {
 public:
  MeshShape(const std::string& name, TriangleMesh surface) : surface_(std::move(surface)) {
    if (surface_.F.rows() == 0) throw Error(ErrorKind::geometry, "collider '" + name + "' has no triangles");
    join_equal_vertices(surface_);
    check_collider_surface(name, surface_);
    // Faces without area have no inside; their neighbours carry the surface.
    const auto corner = [&](int f, int k) -> Eigen::Vector3d { return surface_.V.row(surface_.F(f, k)); };
    const auto doubled_area = [&](int f) -> Eigen::Vector3d {
      return (corner(f, 1) - corner(f, 0)).cross(corner(f, 2) - corner(f, 0));
    };
    std::vector<int> faces;
    for (int f = 0; f < surface_.F.rows(); ++f) {
      if (doubled_area(f).norm() > 0) faces.push_back(f);
    }
    if (faces.empty())
      throw Error(ErrorKind::geometry, "every triangle of collider '" + name + "' is degenerate");
    faces_ = surface_.F(faces, Eigen::all);
    corner_normals_.assign(static_cast<std::size_t>(surface_.V.rows()), Eigen::Vector3d::Zero());
    for (int f = 0; f < faces_.rows(); ++f) {
      const Eigen::Vector3d normal = doubled_area(faces[f]).normalized();
      face_normals_.push_back(normal);
      for (int k = 0; k < 3; ++k) {
        const int face = faces[f];
        corner_normals_[faces_(f, k)] +=
            corner_angle(corner(face, k), corner(face, (k + 1) % 3), corner(face, (k + 2) % 3)) * normal;
        const std::pair<int, int> edge = edge_of(faces_, f, k);
        const auto [it, inserted] = edge_normals_.try_emplace(edge, normal);
        if (inserted) {
          rim_edges_.insert(edge);
        } else {
          it->second += normal;
          rim_edges_.erase(edge);
        }
      }
    }
    for (const auto& [a, b] : rim_edges_) rim_corners_.insert({a, b});
    tree_ = BoxTree(faces_, surface_.V);
  }

  SurfacePoint nearest(const Eigen::Vector3d& point) const override {
    double best2 = INFINITY;
    int f = -1;
    TrianglePlace best = {};
    tree_.visit_near(point, best2, [&](int face) {
      const auto corner = [&](int k) -> Eigen::Vector3d { return surface_.V.row(faces_(face, k)); };
      const TrianglePlace place = nearest_on_triangle(point, corner(0), corner(1), corner(2));
      const double distance2 = (place.position - point).squaredNorm();
      if (!(distance2 < best2 || (distance2 == best2 && face < f))) return;
      best2 = distance2;
      f = face;
      best = place;
    });
    if (f < 0) return {point, Eigen::Vector3d::UnitY(), NAN};  // from beyond all numbers
    const int feature = best.feature;
    Eigen::Vector3d pseudo_normal = face_normals_[f];
    bool rim = false;
    if (feature >= 4) {
      const std::pair<int, int> edge = edge_of(faces_, f, feature - 4);
      pseudo_normal = edge_normals_.at(edge);
      rim = rim_edges_.contains(edge);
    } else if (feature >= 1) {
      const int corner = faces_(f, feature - 1);
      pseudo_normal = corner_normals_[corner];
      rim = rim_corners_.contains(corner);
    }
    const Eigen::Vector3d offset = point - best.position;
    const double length = offset.norm();
    const double sign = !rim && offset.dot(pseudo_normal) < 0 ? -1 : 1;  // there is no inside beyond a rim
    // On a face the offset is along the face normal, which is exact even at distance zero.
    Eigen::Vector3d normal = face_normals_[f];
    if (feature != 0)
      normal = length > 1e-12 ? Eigen::Vector3d(sign * offset / length) : pseudo_normal.normalized();
    return {best.position, normal, sign * length};
  }

  TriangleMesh drawing() const override { return surface_; }

 private:
  TriangleMesh surface_;
  RowMatrixXi faces_;  // those with an area
  BoxTree tree_;
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
