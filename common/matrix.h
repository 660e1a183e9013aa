// Row-major matrices of any size: tables of points, elements and weights with one row per item.
#pragma once

#include <Eigen/Core>

namespace vivify {

using RowMatrixXd = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using RowMatrixXi = Eigen::Matrix<int, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace vivify
