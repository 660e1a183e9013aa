#include "meshing/cage_weights.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/error.h"
#include "common/text.h"

namespace vivify::meshing {
namespace {

template <int kDim>
using Vertices = Eigen::Matrix<double, Eigen::Dynamic, kDim, Eigen::RowMajor>;

// Length of the diagonal of the bounding box.
template <int kDim>
double diagonal_of(const Vertices<kDim>& V) {
  return (V.colwise().maxCoeff() - V.colwise().minCoeff()).norm();
}

template <int kDim>
Eigen::VectorXd project(const Eigen::VectorXd& weights, const Vertices<kDim>& C,
                        const Eigen::Matrix<double, kDim, 1>& x) {
  using Multipliers = Eigen::Matrix<double, kDim + 1, 1>;
  // The minimiser is w = max(0, w0 + A^T y) with A w = b; the multipliers y maximise a concave, piecewise
  // quadratic function of few variables, which a damped Newton method does in finitely many steps.
  const double size = diagonal_of<kDim>(C);
  Eigen::Matrix<double, kDim + 1, Eigen::Dynamic> A(kDim + 1, C.rows());
  A.row(0).setOnes();
  A.template bottomRows<kDim>() = (C.transpose().colwise() - x) / size;
  const Multipliers b = Multipliers::Unit(0);
  const auto primal = [&](const Multipliers& y) { return (weights + A.transpose() * y).cwiseMax(0).eval(); };
  const auto dual = [&](const Multipliers& y) { return y.dot(b) - 0.5 * primal(y).squaredNorm(); };

  Multipliers y = Multipliers::Zero();
  Eigen::VectorXd w = primal(y);
  for (int iteration = 0; iteration < 200; ++iteration) {
    const Multipliers residual = b - A * w;
    if (residual.norm() < 1e-15) break;
    using Matrix = Eigen::Matrix<double, kDim + 1, kDim + 1>;
    Matrix H = Matrix::Zero();
    for (Eigen::Index c = 0; c < C.rows(); ++c) {
      if (w[c] > 0) H += A.col(c) * A.col(c).transpose();
    }
    H.diagonal().array() += 1e-14 * std::max(1.0, H.trace());  // free columns may not span all rows
    const Multipliers step = H.ldlt().solve(residual);
    double length = 1;
    const double start = dual(y), slope = residual.dot(step);
    while (length > 1e-10 && dual(y + length * step) < start + 1e-4 * length * slope - 1e-16) length /= 2;
    y += length * step;
    w = primal(y);
  }
  // A last correction within the free columns takes out round-off.
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<Eigen::Index> free;
    for (Eigen::Index c = 0; c < C.rows(); ++c) {
      if (w[c] > 0) free.push_back(c);
    }
    const Eigen::MatrixXd columns = A(Eigen::all, free);
    const Eigen::VectorXd residual = b - A * w;
    const Eigen::VectorXd change = columns.completeOrthogonalDecomposition().solve(residual);
    for (std::size_t i = 0; i < free.size(); ++i) {
      w[free[i]] = std::max(0.0, w[free[i]] + change[static_cast<Eigen::Index>(i)]);
    }
  }
  if (!((b - A * w).norm() < 1e-11)) {
    throw Error(ErrorKind::numerical, "a point has no weights >= 0 in its cage",
                "it lies outside the convex hull of the cage");
  }
  return w.cwiseMin(1);
}

template <int kDim>
void make_rows_exact(Eigen::MatrixXd& weights, const Vertices<kDim>& C, const Vertices<kDim>& points,
                     HarmonicReport& report) {
  const double diagonal = diagonal_of<kDim>(C);
  report.most_negative = points.rows() == 0 ? 0 : std::min(0.0, weights.minCoeff());
  for (Eigen::Index p = 0; p < points.rows(); ++p) {
    if (weights.row(p).minCoeff() < 0 || weights.row(p).maxCoeff() > 1) {
      weights.row(p) = project<kDim>(weights.row(p), C, points.row(p));
      ++report.projected;
    }
    report.sum_error = std::max(report.sum_error, std::abs(weights.row(p).sum() - 1));
    report.position_error =
        std::max(report.position_error, (weights.row(p) * C - points.row(p)).norm() / diagonal);
  }
  if (report.sum_error > 1e-10 || report.position_error > 1e-10) {
    throw Error(ErrorKind::numerical,
                "the harmonic coordinates do not reproduce the points: error " +
                    number_text(std::max(report.sum_error, report.position_error)),
                "the cage has faces or features that are too thin");
  }
}

}  // namespace

Eigen::VectorXd project_weights(const Eigen::VectorXd& weights, const Points& C, const Eigen::Vector3d& x) {
  return project<3>(weights, C, x);
}
Eigen::VectorXd project_weights(const Eigen::VectorXd& weights, const Points2& C, const Eigen::Vector2d& x) {
  return project<2>(weights, C, x);
}

void make_exact(Eigen::MatrixXd& weights, const Points& C, const Points& points, HarmonicReport& report) {
  make_rows_exact<3>(weights, C, points, report);
}
void make_exact(Eigen::MatrixXd& weights, const Points2& C, const Points2& points, HarmonicReport& report) {
  make_rows_exact<2>(weights, C, points, report);
}

}  // namespace vivify::meshing
