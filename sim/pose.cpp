#include "sim/pose.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/error.h"
#include "common/text.h"
#include "sim/control/rigid_motion.h"
#include "sim/solve/static_solve.h"

namespace vivify::sim {
namespace {

constexpr double kLargestTurn = 10 * std::numbers::pi / 180;  // of a handle in one increment, rad
constexpr double kLargestMove = 0.1;                          // in one increment, of the body's diagonal
constexpr double kLargestScale = 0.1;                         // in one increment, of the factor's logarithm
constexpr double kMaxIncrements = 2000;
constexpr int kMaxHalvings = 6;            // of an increment
constexpr double kSmallestElement = 0.01;  // of its size at rest
constexpr double kSwelling = 0.01;   // the unit of force is what it takes to swell the body by this share
constexpr double kTolerance = 1e-7;  // in that unit

// A handle with its vertices, and its place at a share t of its way.
class Grip {
 public:
  Grip(const PoseHandle& handle, std::vector<int> vertices, const RowMatrixXd& V)
      : handle_(handle), vertices_(std::move(vertices)) {
    if (handle.angle != 0 && V.cols() == 3 && !(handle.axis.norm() > 0)) {
      throw Error(ErrorKind::usage, name() + " turns about an axis without length");
    }
    if (!(handle.scale.minCoeff() > 0)) {
      throw Error(ErrorKind::usage, name() + " has a scale that is not above 0");
    }
    axis_ = V.cols() == 3 ? handle.axis.normalized() : Eigen::Vector3d::UnitZ();
    about_ = handle.about ? place_in_box(V, *handle.about) : middle_of(V, vertices_);
  }

  const std::string& name() const { return handle_.region.handle; }
  const std::vector<int>& vertices() const { return vertices_; }

  // How many increments the whole way takes.
  double increments(double diagonal) const {
    return std::max({std::abs(handle_.angle) / kLargestTurn, handle_.move.norm() / (kLargestMove * diagonal),
                     handle_.scale.array().log().abs().maxCoeff() / kLargestScale});
  }

  void place(const RowMatrixXd& V, double t, Eigen::VectorXd& x) const {
    const Eigen::Index d = V.cols();
    const Eigen::AngleAxisd turn(t * handle_.angle, axis_);
    const Eigen::Vector3d scale = (t * handle_.scale.array().log()).exp();
    for (const int v : vertices_) {
      Eigen::Vector3d arm = -about_;
      for (Eigen::Index k = 0; k < d; ++k) arm[k] += V(v, k);
      const Eigen::Vector3d y = about_ + turn * scale.cwiseProduct(arm) + t * handle_.move;
      for (Eigen::Index k = 0; k < d; ++k) x[d * v + k] = y[k];
    }
  }

 private:
  const PoseHandle& handle_;
  std::vector<int> vertices_;
  Eigen::Vector3d about_, axis_;
};

// Spreads displacements of the held vertices over the others, each of which takes the mean of its neighbours:
// elements beside a handle are not crushed by its first step.
class Spread {
 public:
  Spread(const SimMesh& mesh, const std::vector<bool>& held) : index_(held.size(), -1) {
    int free = 0;
    for (std::size_t v = 0; v < held.size(); ++v) {
      if (!held[v]) index_[v] = free++;
    }
    std::vector<Eigen::Triplet<double>> entries;
    for (const auto& element : mesh.E.rowwise()) {
      for (const int a : element) {
        const int row = index_[static_cast<std::size_t>(a)];
        if (row < 0) continue;
        for (const int b : element) {
          if (a == b) continue;
          entries.emplace_back(row, row, 1 + kFloating);
          const int column = index_[static_cast<std::size_t>(b)];
          if (column < 0) {
            borders_.emplace_back(row, b);
          } else {
            entries.emplace_back(row, column, -1);
          }
        }
      }
    }
    Eigen::SparseMatrix<double> laplacian(free, free);
    laplacian.setFromTriplets(entries.begin(), entries.end());
    solver_.compute(laplacian);
  }

  // `u` is #V by d with the displacements of the held vertices; those of the others are filled in.
  void fill(RowMatrixXd& u) const {
    Eigen::MatrixXd rhs = Eigen::MatrixXd::Zero(solver_.rows(), u.cols());
    if (rhs.rows() == 0) return;
    for (const auto& [row, vertex] : borders_) rhs.row(row) += u.row(vertex);
    const Eigen::MatrixXd inside = solver_.solve(rhs);
    for (std::size_t v = 0; v < index_.size(); ++v) {
      if (index_[v] >= 0) u.row(static_cast<Eigen::Index>(v)) = inside.row(index_[v]);
    }
  }

 private:
  static constexpr double kFloating = 1e-9;   // holds parts that no handle reaches
  std::vector<int> index_;                    // row of each free vertex, or -1
  std::vector<std::pair<int, int>> borders_;  // row, held vertex
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

class PoseSolver {
 public:
  PoseSolver(const SimMesh& rest, const Value& model, std::span<const PoseHandle> handles,
             const Eigen::Vector3d& gravity)
      : rest_(rest),
        model_(build_model(rest, RestLayout::compatible, model)),
        pattern_(static_cast<int>(rest.V.rows()), rest.dimension()),
        held_(static_cast<std::size_t>(rest.V.rows()), false) {
    const int d = rest.dimension();
    std::vector<Region> regions;
    for (const PoseHandle& handle : handles) regions.push_back(handle.region);
    std::vector<std::vector<int>> vertices = held_vertices(regions, rest.V);
    for (std::size_t i = 0; i < handles.size(); ++i) {
      for (const int v : vertices[i]) held_[static_cast<std::size_t>(v)] = true;
      grips_.emplace_back(handles[i], std::move(vertices[i]), rest.V);
    }
    if (grips_.empty()) throw Error(ErrorKind::usage, "a pose needs at least one handle");

    for (const auto& family : model_.families) family->reserve(pattern_);
    for (int v = 0; v < rest.V.rows(); ++v) pattern_.couple(&v, 1);
    pattern_.finish();
    for (const auto& family : model_.families) family->bind(pattern_);
    rest_x_ = Eigen::Map<const Eigen::VectorXd>(rest.V.data(), rest.V.size());
    S_.resize(model_.families.size());
    for (std::size_t f = 0; f < S_.size(); ++f) {
      model_.families[f]->values(Side::deformed, rest_x_, S_[f]);
    }
    force_.resize(rest_x_.size());
    for (Eigen::Index i = 0; i < model_.mass.size(); ++i) {
      for (int k = 0; k < d; ++k) force_[d * i + k] = model_.mass[i] * gravity[k];
    }
  }

  PoseSolution solve() {
    const double diagonal = (rest_.V.colwise().maxCoeff() - rest_.V.colwise().minCoeff()).norm();
    double most = 1;
    for (const Grip& grip : grips_) {
      most = std::max(most, grip.increments(diagonal));
      if (most <= kMaxIncrements) continue;
      throw Error(ErrorKind::usage,
                  grip.name() + " goes too far: " + number_text(std::ceil(most)) + " increments, and " +
                      number_text(kMaxIncrements) + " are the most",
                  "turns are cut into 10 degrees, ways into tenths of the body's diagonal");
    }
    const StaticProblem problem = {model_.families, pattern_, S_, force_, held_};
    const Spread spread(rest_, held_);
    const double tolerance = kTolerance * unit_of_force();
    const double largest = 1 / std::ceil(most);

    PoseSolution solution;
    Eigen::VectorXd x = rest_x_, before = x;
    double t = 0, last = 0;  // share of the way, and the last increment
    double increment = largest;
    int halvings = 0;
    while (t < 1) {
      const double next = t + 1.5 * increment >= 1 ? 1 : t + increment;
      // All goes on as in the last increment; what the handles want besides is spread.
      Eigen::VectorXd start = last > 0 ? Eigen::VectorXd(x + (next - t) / last * (x - before)) : x;
      Eigen::VectorXd wanted = start;
      for (const Grip& grip : grips_) grip.place(rest_.V, next, wanted);
      RowMatrixXd change = rows(wanted) - rows(start);
      spread.fill(change);
      start += Eigen::Map<const Eigen::VectorXd>(change.data(), change.size());
      for (const Grip& grip : grips_) grip.place(rest_.V, next, start);
      StaticSolution trial = solve_static(problem, std::move(start), tolerance);
      solution.iterations += trial.iterations;
      const double smallest = smallest_element(trial.x);
      if (!trial.converged || !(smallest >= kSmallestElement)) {
        if (halvings == kMaxHalvings) fail(t, next, trial, smallest, tolerance);
        ++halvings;
        increment = (next - t) / 2;
        continue;
      }
      before = std::move(x);
      x = std::move(trial.x);
      last = next - t;
      t = next;
      ++solution.increments;
      solution.energy = trial.energy;
      solution.residual = trial.residual;
      solution.smallest_element = smallest;
      halvings = std::max(0, halvings - 1);
      increment = std::min(largest, 2 * increment);
    }
    solution.V = rows(x);
    for (const Grip& grip : grips_) solution.held.push_back(static_cast<int>(grip.vertices().size()));
    return solution;
  }

 private:
  RowMatrixXd rows(const Eigen::VectorXd& x) const {
    return Eigen::Map<const RowMatrixXd>(x.data(), rest_.V.rows(), rest_.V.cols());
  }

  double unit_of_force() const {
    Eigen::VectorXd s, g, force = Eigen::VectorXd::Zero(rest_x_.size());
    for (std::size_t f = 0; f < S_.size(); ++f) {
      const MeasureFamily& family = *model_.families[f];
      family.gradients(Side::deformed, (1 + kSwelling) * rest_x_, s, g);
      family.scatter(Side::deformed, g, family.law().stress({family.coefficients(), s, S_[f]}), force);
    }
    return force.lpNorm<Eigen::Infinity>();
  }

  // Smallest area or volume over that at rest; 1 for bodies without.
  double smallest_element(const Eigen::VectorXd& x) const {
    double smallest = 1;
    for (std::size_t f = 0; f < S_.size(); ++f) {
      if (model_.families[f]->kind() != MeasureKind::size) continue;
      Eigen::VectorXd s;
      model_.families[f]->values(Side::deformed, x, s);
      smallest = std::min(smallest, s.cwiseQuotient(S_[f]).minCoeff());
    }
    return smallest;
  }

  [[noreturn]] static void fail(double t, double next, const StaticSolution& trial, double smallest,
                                double tolerance) {
    const std::string way =
        "the handles came " + number_text(std::round(1000 * t) / 10) + " % of their way; ";
    if (!trial.converged) {
      throw Error(ErrorKind::numerical,
                  way + "at " + number_text(std::round(1000 * next) / 10) +
                      " % no equilibrium was found (a force of " + number_text(trial.residual) +
                      " N was left, " + number_text(tolerance) + " N is allowed)",
                  "move the handles less, or let them hold other parts of the body");
    }
    throw Error(ErrorKind::numerical,
                way + "then an element is squeezed to " + number_text(std::round(1000 * smallest) / 1000) +
                    " of its size",
                "move the handles less, let them hold less of the body, or raise model.volume_stiffness");
  }

  const SimMesh& rest_;
  ElasticModel model_;
  SymmetricPattern pattern_;
  std::vector<bool> held_;
  std::vector<Grip> grips_;
  Eigen::VectorXd rest_x_, force_;
  std::vector<Eigen::VectorXd> S_;
};

}  // namespace

PoseSolution solve_pose(const SimMesh& rest, const Value& model, std::span<const PoseHandle> handles,
                        const Eigen::Vector3d& gravity) {
  return PoseSolver(rest, model, handles, gravity).solve();
}

}  // namespace vivify::sim
