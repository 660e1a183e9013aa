#include "sim/region.h"

#include <utility>

namespace vivify::sim {
namespace {

constexpr double kMargin = 1e-9;  // of the bounding box: points on the face of a region belong to it

Eigen::Vector3d spatial(const Eigen::RowVectorXd& point) {
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  result.head(point.size()) = point.transpose();
  return result;
}

std::vector<int> vertices_in(const Region& region, const RowMatrixXd& V) {
  std::vector<bool> chosen(static_cast<std::size_t>(V.rows()), false);
  for (const int v : region.vertices) {
    if (v < 0 || v >= V.rows()) {
      throw Error(ErrorKind::usage,
                  region.handle + " names vertex " + std::to_string(v) + ", and the simulation mesh has " +
                      std::to_string(V.rows()),
                  "", region.where);
    }
    chosen[static_cast<std::size_t>(v)] = true;
  }
  const auto d = V.cols();
  const Eigen::RowVectorXd from =
                               place_in_box(V, (region.min.array() - kMargin).matrix()).head(d).transpose(),
                           to = place_in_box(V, (region.max.array() + kMargin).matrix()).head(d).transpose();
  std::vector<int> vertices;
  for (int v = 0; v < static_cast<int>(V.rows()); ++v) {
    const bool inside = (V.row(v).array() >= from.array()).all() && (V.row(v).array() <= to.array()).all();
    if (inside || chosen[static_cast<std::size_t>(v)]) vertices.push_back(v);
  }
  if (vertices.empty()) {
    throw Error(ErrorKind::usage, region.handle + " takes hold of no vertex",
                "make its region larger; regions are shares of the bounding box of the body", region.where);
  }
  return vertices;
}

}  // namespace

Region region_between(const Value& corners, std::string handle, Location where) {
  return {std::move(handle), corners["min"].as_vector3(), corners["max"].as_vector3(), {}, std::move(where)};
}

std::vector<std::vector<int>> held_vertices(std::span<const Region> regions, const RowMatrixXd& V) {
  std::vector<std::vector<int>> held;
  std::vector<const Region*> holder(static_cast<std::size_t>(V.rows()), nullptr);
  for (const Region& region : regions) {
    held.push_back(vertices_in(region, V));
    for (const int v : held.back()) {
      const Region*& other = holder[static_cast<std::size_t>(v)];
      if (other != nullptr) {
        throw Error(
            ErrorKind::usage,
            other->handle + " and " + region.handle + " both take hold of vertex " + std::to_string(v),
            "make their regions smaller", region.where);
      }
      other = &region;
    }
  }
  return held;
}

Eigen::Vector3d place_in_box(const RowMatrixXd& V, const Eigen::Vector3d& shares) {
  const Eigen::Vector3d low = spatial(V.colwise().minCoeff()), high = spatial(V.colwise().maxCoeff());
  return low + shares.cwiseProduct(high - low);
}

Eigen::Vector3d middle_of(const RowMatrixXd& V, const std::vector<int>& vertices) {
  const RowMatrixXd held = V(vertices, Eigen::all);
  return spatial((held.colwise().minCoeff() + held.colwise().maxCoeff()) / 2);
}

}  // namespace vivify::sim
