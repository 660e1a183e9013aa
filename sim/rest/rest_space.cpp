#include "sim/rest/rest_space.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <map>

#include "common/registry.h"

namespace vivify::sim {
namespace {

constexpr double kLeastHeight = 0.2;  // of the diagonal

constexpr std::array<RestSpaceEntry, 4> kSpaces = {{
    {"cage", RestLayout::compatible, make_cage_space},
    {"examples", RestLayout::incompatible, make_examples_space},
    {"full", RestLayout::compatible, make_full_space},
    {"strains", RestLayout::compatible, make_strains_space},
}};

// The rigid motions of a shape: translations and linearised rotations (d #points by 3 or 6).
Eigen::MatrixXd rigid_motions(const Eigen::VectorXd& X0, int d) {
  const Eigen::Index points = X0.size() / d;
  Eigen::VectorXd centre = Eigen::VectorXd::Zero(d);
  for (Eigen::Index i = 0; i < points; ++i) centre += X0.segment(d * i, d) / static_cast<double>(points);
  Eigen::MatrixXd rigid = Eigen::MatrixXd::Zero(X0.size(), d == 2 ? 3 : 6);
  for (Eigen::Index i = 0; i < points; ++i) {
    Eigen::Vector3d arm = Eigen::Vector3d::Zero();
    arm.head(d) = X0.segment(d * i, d) - centre;
    for (int axis = 0; axis < d; ++axis) rigid(d * i + axis, axis) = 1;
    for (int k = d; k < rigid.cols(); ++k) {
      const Eigen::Vector3d axis = Eigen::Vector3d::Unit(d == 2 ? 2 : k - d);
      const Eigen::Vector3d motion = axis.cross(arm);
      for (int n = 0; n < d; ++n) rigid(d * i + n, k) = motion[n];
    }
  }
  return rigid;
}

}  // namespace

std::span<const RestSpaceEntry> rest_spaces() { return kSpaces; }
const RestSpaceEntry& rest_space_entry(std::string_view name) {
  return find_entry(rest_spaces(), name, "rest space");
}

Eigen::MatrixXd shape_changing_basis(const Eigen::VectorXd& X0, const Eigen::MatrixXd& L, int dimension) {
  const Eigen::Index parameters = L.cols();
  const Eigen::MatrixXd rigid = rigid_motions(X0, dimension);
  // Parameters that do nothing: with L P = Q [R₁ R₂] they are P [−R₁⁻¹ R₂; 1].
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> least_squares(L);
  least_squares.setThreshold(1e-10);
  const Eigen::Index rank = least_squares.rank();
  Eigen::MatrixXd null_parameters =
      Eigen::MatrixXd::Identity(parameters, parameters).rightCols(parameters - rank);
  if (rank < parameters) {
    const auto R = least_squares.matrixR();
    null_parameters.topRows(rank) = -R.topLeftCorner(rank, rank)
                                         .triangularView<Eigen::Upper>()
                                         .solve(R.topRightCorner(rank, parameters - rank));
    null_parameters = (least_squares.colsPermutation() * null_parameters).eval();
  }
  // Parameters that produce each rigid motion, kept where L really can produce it.
  for (Eigen::Index motion = 0; motion < rigid.cols(); ++motion) {
    const Eigen::VectorXd p = least_squares.solve(rigid.col(motion));
    if ((L * p - rigid.col(motion)).norm() < 1e-6 * rigid.col(motion).norm()) {
      null_parameters.conservativeResize(Eigen::NoChange, null_parameters.cols() + 1);
      null_parameters.rightCols<1>() = p;
    }
  }
  if (null_parameters.cols() == 0) return Eigen::MatrixXd::Identity(parameters, parameters);
  const Eigen::MatrixXd Q = Eigen::HouseholderQR<Eigen::MatrixXd>(null_parameters).householderQ();
  return Q.rightCols(parameters - null_parameters.cols());
}

Eigen::VectorXd stack(const RowMatrixXd& V, const RestPoints& points) {
  const Eigen::Index d = V.cols();
  Eigen::VectorXd X(d * points.size());
  for (int i = 0; i < points.size(); ++i) {
    X.segment(d * i, d) = V.row(points.vertex[static_cast<std::size_t>(i)]).transpose();
  }
  return X;
}

double unit_length(const RowMatrixXd& V) {
  const Eigen::RowVectorXd extent = V.colwise().maxCoeff() - V.colwise().minCoeff();
  return std::max(extent[1], kLeastHeight * extent.norm());
}

std::vector<std::vector<int>> example_groups(const std::vector<ExamplePose>& examples) {
  std::map<std::string, std::vector<int>> groups;
  for (std::size_t k = 0; k < examples.size(); ++k) groups[examples[k].group].push_back(static_cast<int>(k));
  std::vector<std::vector<int>> lists;
  for (auto& [name, members] : groups) lists.push_back(std::move(members));
  return lists;
}

ShapeSpace::ShapeSpace(Eigen::VectorXd X0, const Eigen::MatrixXd& L, Eigen::MatrixXd basis, double unit,
                       Eigen::MatrixXd poses, std::vector<std::vector<int>> groups)
    : RestSpace(std::move(basis), unit, std::move(poses), std::move(groups)),
      X0_(std::move(X0)),
      Lq_(L * this->basis()) {}

void ShapeSpace::measures(const ElasticFamilies& families, const Eigen::VectorXd& q,
                          std::vector<Eigen::VectorXd>& S, std::vector<RowMatrixXd>* J) const {
  const Eigen::VectorXd X = shape(q);
  S.resize(families.size());
  if (J != nullptr) J->resize(families.size());
  Eigen::VectorXd G;
  for (std::size_t f = 0; f < families.size(); ++f) {
    if (J == nullptr) {
      families[f]->values(Side::rest, X, S[f]);
    } else {
      families[f]->gradients(Side::rest, X, S[f], G);
      (*J)[f] = families[f]->gather(Side::rest, G, Lq_);
    }
  }
}

void ShapeSpace::add_hessians(const ElasticFamilies& families, const Eigen::VectorXd& q,
                              const std::vector<Eigen::VectorXd>& weights, Eigen::MatrixXd& C) const {
  const Eigen::VectorXd X = shape(q);
  for (std::size_t f = 0; f < families.size(); ++f) families[f]->add_rest_hessians(X, weights[f], Lq_, C);
}

}  // namespace vivify::sim
