#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>

#include "bench/validation/bodies.h"
#include "bench/validation/lattice.h"
#include "bench/validation/problem.h"
#include "meshing/harmonic.h"
#include "meshing/planar_harmonic.h"

namespace vivify::validation {
namespace {

// The vertices a (#V by d), moved rigidly to fit b best.
RowMatrixXd fitted(const RowMatrixXd& a, const RowMatrixXd& b) {
  const Eigen::RowVectorXd ca = a.colwise().mean(), cb = b.colwise().mean();
  const Matrix covariance = (a.rowwise() - ca).transpose() * (b.rowwise() - cb);
  const Eigen::JacobiSVD<Matrix> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix flip = Matrix::Identity(a.cols(), a.cols());
  flip(a.cols() - 1, a.cols() - 1) = (svd.matrixV() * svd.matrixU().transpose()).determinant() < 0 ? -1 : 1;
  const Matrix R = svd.matrixV() * flip * svd.matrixU().transpose();
  return ((a.rowwise() - ca) * R.transpose()).rowwise() + cb;
}

double distance(const RowMatrixXd& a, const RowMatrixXd& b) {
  return (fitted(a, b) - b).rowwise().norm().maxCoeff();
}

// The shape at rest for weights p of the examples, from the undeformed shape.
RowMatrixXd at_rest(const sim::BodyModel& body, const Vector& p) {
  std::vector<Vector> S;
  body.rest->measures(body.elastic, p, S, nullptr);
  const Vector X = flat(body.mesh.V);
  sim::SymmetricMatrix D(*body.pattern);
  stiffness(body, body.S0, X, D);
  const double stiffest = D.lower().diagonal().maxCoeff();
  const sim::StaticSolution solution =
      sim::solve_static({body.elastic, *body.pattern, S, Vector::Zero(X.size()),
                         std::vector<bool>(static_cast<std::size_t>(body.mesh.V.rows()), false)},
                        X, 1e-12 * stiffest);
  if (!solution.converged) throw Error(ErrorKind::numerical, "the interpolated shape was not found");
  return solution.x.reshaped<Eigen::RowMajor>(body.mesh.V.rows(), body.dimension());
}

// How far a body turns from one end to the other, in the plane of x and y.
double bend_angle(const RowMatrixXd& reference, const RowMatrixXd& shape) {
  const RowMatrixXd V = fitted(shape, reference);
  // Least squares for the linear map of the vertices at either end.
  const auto direction = [&](bool right) {
    const double low = reference.col(0).minCoeff(), length = reference.col(0).maxCoeff() - low;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero(), centre = Eigen::Vector2d::Zero();
    double x_sum = 0, count = 0;
    const auto inside = [&](Eigen::Index i) {
      const double t = (reference(i, 0) - low) / length;
      return right ? t > 0.6 : t < 0.4;
    };
    for (Eigen::Index i = 0; i < V.rows(); ++i) {
      if (!inside(i)) continue;
      centre += V.row(i).head<2>().transpose();
      x_sum += reference(i, 0);
      ++count;
    }
    for (Eigen::Index i = 0; i < V.rows(); ++i) {
      if (inside(i))
        sum += (reference(i, 0) - x_sum / count) * (V.row(i).head<2>().transpose() - centre / count);
    }
    return sum;
  };
  const Eigen::Vector2d a = direction(false), b = direction(true);
  return std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
}

void check_examples(Effort effort, Result& result) {
  Plot plot{"interpolation", "Bending between two examples", "weight of the example",
            "turn between the ends, over that of the example"};
  Curve linear{"linear in the weight", {}, {}, true};
  for (const double p : {0.0, 1.0}) linear.add(p, p);
  plot.curves.push_back(std::move(linear));
  for (const Sample& sample : samples()) {
    const sim::BodyModel body = sample_body(sample, "examples");
    const double length = (sample.mesh.V.colwise().maxCoeff() - sample.mesh.V.colwise().minCoeff()).norm();
    const RowMatrixXd poses[] = {bent_pose(sample.mesh, 0.6), bent_pose(sample.mesh, -0.5)};
    Largest error;
    for (int k = 0; k < 2; ++k) error.add(distance(at_rest(body, Vector::Unit(2, k)), poses[k]) / length);
    result.figure(sample.model + ": at rest with weight 1 of an example, distance from it over the length",
                  error.value, 0, 1e-6);
    result.figure(sample.model + ": at rest without weights, distance from the rest shape over the length",
                  distance(at_rest(body, Vector::Zero(2)), sample.mesh.V) / length, 0, 1e-12);
    const double start = bend_angle(sample.mesh.V, sample.mesh.V),
                 whole = bend_angle(sample.mesh.V, poses[0]) - start;
    Curve ours{sample.model};
    Largest departure;
    const int steps = effort == Effort::full ? 20 : 4;
    for (int i = 0; i <= steps; ++i) {
      const double p = static_cast<double>(i) / steps;
      const double turn = (bend_angle(sample.mesh.V, at_rest(body, p * Vector::Unit(2, 0))) - start) / whole;
      ours.add(p, turn);
      departure.add(std::abs(turn - p));
    }
    result.figure(sample.model + ": turn between the ends, departure from linear interpolation of angles",
                  departure.value, 0, 0.02);
    plot.curves.push_back(std::move(ours));
  }
  result.plots.push_back(std::move(plot));
}

struct Facts {
  Largest sum, linear, negative;
  void add(const Matrix& weights, const Matrix& cage, const Matrix& points) {
    sum.add((weights.rowwise().sum().array() - 1).abs().maxCoeff());
    linear.add((weights * cage - points).cwiseAbs().maxCoeff());
    negative.add(std::max(0.0, -weights.minCoeff()));
  }
};

void check_cages(Result& result) {
  CounterRng rng(41);
  // A square in the plane: x y is harmonic and linear along the sides, so the coordinates are bilinear.
  Points2 square(4, 2), inside(60, 2);
  square << -1, -1, 1, -1, 1, 1, -1, 1;
  inside = random_vector(120, 0.9, rng).reshaped(60, 2);
  const Matrix weights = meshing::harmonic_coordinates(square, inside);
  Largest bilinear;
  Plot plot{"harmonic", "Harmonic coordinates of a square beside bilinear ones", "bilinear", "harmonic"};
  Curve ours{"60 random points, 4 corners"}, line{"equal", {0, 1}, {0, 1}, true};
  for (Eigen::Index i = 0; i < inside.rows(); ++i) {
    for (Eigen::Index c = 0; c < 4; ++c) {
      const double exact = (1 + inside(i, 0) * square(c, 0)) * (1 + inside(i, 1) * square(c, 1)) / 4;
      bilinear.add(std::abs(weights(i, c) - exact));
      ours.add(exact, weights(i, c));
    }
  }
  plot.curves = {line, ours};
  Facts plane;
  plane.add(weights, square, inside);
  // A cage with a notch.
  Points2 notched(8, 2), arms(40, 2);
  notched << 0, 0, 3, 0, 3, 2, 2, 2, 2, 1, 1, 1, 1, 2, 0, 2;
  for (Eigen::Index i = 0; i < arms.rows(); ++i) {
    arms(i, 0) = (i % 2 == 0 ? 0.1 : 2.1) + 0.8 * rng.uniform();
    arms(i, 1) = rng.uniform(0.1, 1.9);
  }
  plane.add(meshing::harmonic_coordinates(notched, arms), notched, arms);
  // An octahedron.
  TriangleMesh octahedron;
  octahedron.V.resize(6, 3);
  octahedron.V << 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1;
  octahedron.F.resize(8, 3);
  octahedron.F << 0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5;
  const Points cloud = random_vector(150, 0.3, rng).reshaped(50, 3);
  Facts space;
  space.add(meshing::harmonic_coordinates(octahedron, cloud), octahedron.V, cloud);
  result.figure("harmonic coordinates of a square beside bilinear ones, largest difference", bilinear.value,
                0, 2e-3);
  for (const auto& [name, facts] : {std::pair{"plane", plane}, std::pair{"space", space}}) {
    const std::string where = std::string("harmonic coordinates, ") + name;
    result.figure(where + ": |sum − 1|", facts.sum.value, 0, 1e-9);
    result.figure(where + ": |linear functions − themselves|", facts.linear.value, 0, 1e-9);
    result.figure(where + ": most negative weight", facts.negative.value, 0, 0);
  }
  result.plots.push_back(std::move(plot));
}

}  // namespace

Result interpolation(Effort effort) {
  Result result;
  result.title = "Examples and cages";
  result.text =
      "Weight 1 of an example (space `examples`, elements interpolated after registration) has the example "
      "as its "
      "equilibrium, found by the static solver from the undeformed shape and compared after the best rigid "
      "motion; "
      "without weights it is the rest shape. Between the two, the turn from one end to the other stays close "
      "to linear "
      "in the weight. (Figures 4 and 5 of the paper, with their reference methods, have scenes of their "
      "own.) "
      "Harmonic coordinates sum to 1, reproduce linear functions and are not negative; those of a square are "
      "known, "
      "since x y is harmonic and linear along the sides: bilinear.";
  check_examples(effort, result);
  check_cages(result);
  return result;
}

}  // namespace vivify::validation
