#include <Eigen/QR>

#include "sim/rest/registration.h"
#include "sim/rest/rest_space.h"

namespace vivify::sim {
namespace {

// What a pose moves by less than this share of the unit of length stays in its place: its soles.
constexpr double kInPlace = 0.01;
constexpr double kWeightInPlace = 30;  // against what moves

// Displacements of the cage vertices (d #C) that bring the rest vertices nearest to the pose.
Eigen::VectorXd nearest_cage(const Eigen::MatrixXd& weights, const RowMatrixXd& V, const RowMatrixXd& pose) {
  const RowMatrixXd moved = pose - V;
  const Eigen::VectorXd importance =
      (moved.rowwise().norm().array() < kInPlace * unit_length(V))
          .select(Eigen::VectorXd::Constant(V.rows(), kWeightInPlace), Eigen::VectorXd::Ones(V.rows()));
  const RowMatrixXd cage = (importance.asDiagonal() * weights)
                               .completeOrthogonalDecomposition()
                               .solve(importance.asDiagonal() * moved);
  return Eigen::Map<const Eigen::VectorXd>(cage.data(), cage.size());
}

}  // namespace

std::unique_ptr<RestSpace> make_cage_space(const RestSpaceInput& input) {
  const RowMatrixXd& V = input.reference.V;
  const Eigen::MatrixXd& weights = input.cage_weights;
  const Eigen::Index d = V.cols();
  if (weights.rows() != V.rows()) {
    throw Error(ErrorKind::internal, "cage weights are of another mesh");
  }
  Eigen::MatrixXd L = Eigen::MatrixXd::Zero(d * V.rows(), d * weights.cols());
  for (Eigen::Index i = 0; i < weights.rows(); ++i) {
    for (Eigen::Index c = 0; c < weights.cols(); ++c) {
      L.block(d * i, d * c, d, d).diagonal().setConstant(weights(i, c));
    }
  }
  Eigen::VectorXd X0 = stack(V, input.points);
  Eigen::MatrixXd basis = shape_changing_basis(X0, L, input.reference.dimension());
  Eigen::MatrixXd poses(L.cols(), static_cast<Eigen::Index>(input.examples.size()));
  for (std::size_t k = 0; k < input.examples.size(); ++k) {
    const ExamplePose& pose = input.examples[k];
    check_pose(pose, input.reference);
    poses.col(static_cast<Eigen::Index>(k)) = nearest_cage(weights, V, pose.V);
  }
  return std::make_unique<ShapeSpace>(std::move(X0), L, std::move(basis), unit_length(V), std::move(poses));
}

}  // namespace vivify::sim
