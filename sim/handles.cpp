#include "sim/handles.h"

namespace vivify::sim {
namespace {

constexpr double kSag = 1e-5;  // of its height: how far a body that hangs from one handle sags

}  // namespace

double Hold::energy(const Eigen::VectorXd& x) const {
  double sum = 0;
  for (const Spring& spring : springs_) sum += 0.5 * spring.stiffness * stretch(spring, x).squaredNorm();
  return sum;
}

void Hold::add_gradient(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) const {
  for (const Spring& spring : springs_) {
    gradient.segment(dimension_ * spring.vertex, dimension_) +=
        spring.stiffness * stretch(spring, x).head(dimension_);
  }
}

void Hold::add_hessian(const std::vector<int>& diagonal_slots, SymmetricMatrix& matrix) const {
  for (const Spring& spring : springs_) {
    for (int k = 0; k < dimension_; ++k) {
      matrix.values()[diagonal_slots[static_cast<std::size_t>(dimension_ * spring.vertex + k)]] +=
          spring.stiffness;
    }
  }
}

Eigen::Vector3d Hold::total_force(const Eigen::VectorXd& x) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Spring& spring : springs_) sum -= spring.stiffness * stretch(spring, x);
  return sum;
}

Handles::Handles(std::vector<Handle> handles, const RowMatrixXd& V, double stiffness)
    : stiffness_(stiffness / kSag), dimension_(static_cast<int>(V.cols())) {
  std::vector<Region> regions;
  for (const Handle& handle : handles) regions.push_back(handle.region);
  std::vector<std::vector<int>> vertices = held_vertices(regions, V);
  for (std::size_t i = 0; i < handles.size(); ++i) {
    Part part = {std::move(handles[i]), std::move(vertices[i]), {}, {}};
    part.rest = Points::Zero(static_cast<Eigen::Index>(part.vertices.size()), 3);
    part.rest.leftCols(dimension_) = V(part.vertices, Eigen::all);
    part.about = part.handle.about ? place_in_box(V, *part.handle.about) : middle_of(V, part.vertices);
    parts_.push_back(std::move(part));
  }
}

Hold Handles::at(double end, double h) const {
  std::vector<Hold::Spring> springs;
  for (const Part& part : parts_) {
    if (end > part.handle.until + kTimeTolerance * h) continue;
    const Eigen::Isometry3d pose = part.handle.motion.pose(end);
    const double share = stiffness_ / static_cast<double>(part.vertices.size());
    for (std::size_t i = 0; i < part.vertices.size(); ++i) {
      const Eigen::Vector3d arm = part.rest.row(static_cast<Eigen::Index>(i)).transpose() - part.about;
      Eigen::Vector3d place = part.about + pose * arm;
      if (dimension_ == 2) place.z() = 0;
      springs.push_back({part.vertices[i], share, place});
    }
  }
  return {std::move(springs), dimension_};
}

}  // namespace vivify::sim
