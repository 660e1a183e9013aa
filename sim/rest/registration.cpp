#include "sim/rest/registration.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

namespace vivify::sim {
namespace {

using Columns = Eigen::MatrixXd;  // d by #points of an element

Columns points_of(const Eigen::VectorXd& X, int d, int begin, int end) {
  return Eigen::Map<const Columns>(X.data() + d * begin, d, end - begin);
}

[[noreturn]] void fail(const std::string& pose, int element, const std::string& what) {
  throw Error(ErrorKind::geometry, "example '" + pose + "': element " + std::to_string(element) + " " + what,
              "an example must be a deformation without folds of the rest shape; make it again with smaller "
              "changes");
}

// The rotation of the polar decomposition of F = S_k S_0⁻¹. Empty when F turns the element inside out.
Eigen::MatrixXd simplex_rotation(const Columns& posed, const Columns& rest) {
  const Eigen::Index d = rest.rows();
  const Eigen::MatrixXd S0 = rest.rightCols(d).colwise() - rest.col(0);
  const Eigen::MatrixXd Sk = posed.rightCols(d).colwise() - posed.col(0);
  const Eigen::MatrixXd F = Sk * S0.inverse();
  if (!(F.determinant() > 0)) return {};
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

// Axes of an element round a centre edge: along the edge, and in space the mean normal of its triangles and
// their product. Empty when they are not defined.
Eigen::MatrixXd edge_frame(const Columns& x) {
  const Eigen::VectorXd e = (x.col(1) - x.col(0)).normalized();
  if (!(e.norm() > 0.5)) return {};
  if (x.rows() == 2) {
    Eigen::Matrix2d frame;
    frame << e[0], -e[1], e[1], e[0];
    return frame;
  }
  const auto normal = [&](Eigen::Index k, double sign) -> Eigen::Vector3d {
    const Eigen::Vector3d edge = x.col(1) - x.col(0), arm = x.col(k) - x.col(0);
    return sign * edge.cross(arm).normalized();
  };
  Eigen::Vector3d n = normal(2, 1);
  if (x.cols() == 4) {
    const Eigen::Vector3d other = normal(3, -1);
    if (!(n.norm() > 0.5) || !(other.norm() > 0.5)) return {};
    n = (n + other).normalized();
  }
  if (!(n.norm() > 0.5)) return {};
  Eigen::Matrix3d frame;
  frame << e, n, Eigen::Vector3d(e).cross(n);
  return frame;
}

}  // namespace

Eigen::VectorXd register_elements(const Eigen::VectorXd& posed, const Eigen::VectorXd& rest,
                                  const RestPoints& points, int dimension, const std::string& pose) {
  Eigen::VectorXd result(posed.size());
  for (std::size_t e = 0; e + 1 < points.element_begin.size(); ++e) {
    const int begin = points.element_begin[e], end = points.element_begin[e + 1], n = end - begin;
    const Columns from = points_of(posed, dimension, begin, end), to = points_of(rest, dimension, begin, end);
    Eigen::MatrixXd R;
    Eigen::VectorXd from_centre, to_centre;
    if (points.centre_edge) {
      const Eigen::MatrixXd posed_frame = edge_frame(from), rest_frame = edge_frame(to);
      if (posed_frame.size() == 0 || rest_frame.size() == 0) {
        fail(pose, static_cast<int>(e), "has an edge or a triangle without size, or is folded flat");
      }
      R = posed_frame * rest_frame.transpose();
      from_centre = (from.col(0) + from.col(1)) / 2;
      to_centre = (to.col(0) + to.col(1)) / 2;
    } else {
      R = simplex_rotation(from, to);
      if (R.size() == 0) fail(pose, static_cast<int>(e), "is turned inside out or has no size");
      from_centre = from.rowwise().mean();
      to_centre = to.rowwise().mean();
    }
    const Columns aligned = (R.transpose() * (from.colwise() - from_centre)).colwise() + to_centre;
    result.segment(dimension * begin, dimension * n) =
        Eigen::Map<const Eigen::VectorXd>(aligned.data(), aligned.size());
  }
  return result;
}

void check_pose(const ExamplePose& pose, const SimMesh& mesh) {
  if (pose.V.rows() != mesh.V.rows() || pose.V.cols() != mesh.V.cols()) {
    throw Error(ErrorKind::geometry,
                "example '" + pose.name + "' has " + std::to_string(pose.V.rows()) +
                    " points and the simulation mesh has " + std::to_string(mesh.V.rows()),
                "an example is a pose of the simulation mesh itself; make it with `vivify pose`");
  }
  if (!pose.V.allFinite()) {
    throw Error(ErrorKind::geometry, "example '" + pose.name + "' has coordinates that are not finite");
  }
}

}  // namespace vivify::sim
