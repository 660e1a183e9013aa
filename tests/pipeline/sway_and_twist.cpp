#include "tests/pipeline/sway_and_twist.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

namespace vivify::testing_support {
namespace {

// The rotation that best takes some vertices (#V by 3) from `a` to `b`.
Eigen::Matrix3d turn_of(const RowMatrixXd& a, const RowMatrixXd& b, const std::vector<int>& vertices) {
  const Eigen::Matrix3Xd from = a(vertices, Eigen::all).transpose(), to = b(vertices, Eigen::all).transpose();
  return Eigen::umeyama(from, to, false).topLeftCorner<3, 3>();
}

// The vertices between two heights, shares of the height of the body.
std::vector<int> between(const RowMatrixXd& rest, double low, double high) {
  const double foot = rest.col(1).minCoeff(), height = rest.col(1).maxCoeff() - foot;
  std::vector<int> vertices;
  for (int v = 0; v < rest.rows(); ++v) {
    const double share = (rest(v, 1) - foot) / height;
    if (share >= low && share <= high) vertices.push_back(v);
  }
  return vertices;
}

double yaw(const Eigen::Matrix3d& R) {
  return std::atan2(R(0, 2) - R(2, 0), R(0, 0) + R(2, 2)) * 180 / std::numbers::pi;
}

double spread(const std::vector<double>& values) {
  const Eigen::Map<const Eigen::ArrayXd> all(values.data(), static_cast<Eigen::Index>(values.size()));
  return std::sqrt((all - all.mean()).square().mean());
}

}  // namespace

double sway_deg(const SceneResult& run, const std::string& body) {
  const std::vector<RowMatrixXd> frames = run.motion(body);
  const std::vector<int> all = between(frames.front(), 0, 1);
  std::vector<double> angles;
  for (const RowMatrixXd& x : frames) {
    const Eigen::Matrix3d R = turn_of(frames.front(), x, all);
    const Eigen::Vector3d left = Eigen::Vector3d::UnitY().cross(R.col(2)).normalized();
    angles.push_back(std::atan2(R.col(1).dot(left), R(1, 1)) * 180 / std::numbers::pi);
  }
  return spread(angles);
}

double twist_deg(const SceneResult& run, const std::string& body) {
  const std::vector<RowMatrixXd> frames = run.motion(body);
  const std::vector<int> upper = between(frames.front(), 2.0 / 3, 1),
                         lower = between(frames.front(), 0, 1.0 / 3);
  std::vector<double> angles;
  for (const RowMatrixXd& x : frames) {
    const double twist = yaw(turn_of(frames.front(), x, upper)) - yaw(turn_of(frames.front(), x, lower));
    angles.push_back(std::remainder(twist, 360));
  }
  return spread(angles);
}

}  // namespace vivify::testing_support
