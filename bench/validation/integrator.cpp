#include <Eigen/Eigenvalues>
#include <cmath>

#include "bench/validation/bodies.h"
#include "bench/validation/lattice.h"
#include "bench/validation/problem.h"
#include "common/rng.h"

namespace vivify::validation {
namespace {

struct Modes {
  Vector omega;  // rad/s
  Matrix shape;  // columns
};
Modes modes(const sim::BodyModel& body) {
  sim::SymmetricMatrix K(*body.pattern);
  stiffness(body, body.S0, flat(body.mesh.V), K);
  const Matrix M = coordinate_masses(body).asDiagonal();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(K * Matrix::Identity(M.rows(), M.cols()), M);
  return {solver.eigenvalues().cwiseMax(0).cwiseSqrt(), solver.eigenvectors()};
}

// The factor by which the amplitude of a small vibration falls in one step, from √(energy) over a few steps
// for a vibration without damping. With damping the complex amplitude follows u₊ = z u; |z|² is the
// determinant of the linear map (u, v) → (u₊, v₊), measured from two starts.
double decay(const sim::BodyModel& body, const Vector& shape, double h) {
  const Vector X = flat(body.mesh.V), mass = coordinate_masses(body);
  const double reach = 1e-5 / shape.cwiseAbs().maxCoeff();
  const auto project = [&](const Vector& u) { return shape.dot(mass.cwiseProduct(u)) / reach; };
  Eigen::Matrix2d map;
  for (int start = 0; start < 2; ++start) {
    const Vector kick = reach * shape;
    Motion motion(body, start == 0 ? Vector(X + kick) : X, start == 1 ? Vector(kick / h) : Vector(0 * kick),
                  h);
    motion.step(Vector(0));
    map.col(start) << project(motion.x() - X), h * project(motion.v());
  }
  return std::sqrt(map.determinant());
}

}  // namespace

Result integrator(Effort effort) {
  Result result;
  result.title = "Damping of the integrator, and Rayleigh's";
  result.text =
      "Vibration modes of free bodies of every model, from their stiffness and mass matrices, set going with "
      "an "
      "amplitude of 1e-5 m. Implicit Euler takes u″ = −ω² u to a step whose amplitude falls by exactly (1 + "
      "ω² h²)^(−1/2), "
      "and with Rayleigh's damping β by (1 + ω² h² + β ω² h)^(−1/2), whose limit for small h is exp(−β ω² "
      "h/2) as the "
      "setting `damping_s` says. Measured: the root of the determinant of the step as a linear map of "
      "amplitude and "
      "velocity. Then, strongly deformed bodies with a fixed rest shape: their energy never rises in a step, "
      "and "
      "neither damping changes the momentum.";
  const std::vector<double> products = effort == Effort::full
                                           ? std::vector<double>{0.01, 0.03, 0.1, 0.2, 0.5, 1, 2, 5, 10}
                                           : std::vector<double>{0.01, 0.1, 1, 10};
  constexpr double kBetaOmega = 0.5;
  Plot plot{"integrator", "Amplitude after one step of implicit Euler",
            "ω h",        "share of the amplitude lost",
            true,         true};
  Curve plain{"1 − (1 + ω²h²)^(−1/2)", {}, {}, true},
      damped{"1 − (1 + ω²h² + βω²h)^(−1/2), βω = 0.5", {}, {}, true};
  for (double y = 0.01; y <= 10.01; y *= std::pow(10, 0.1)) {
    plain.add(y, 1 - 1 / std::sqrt(1 + y * y));
    damped.add(y, 1 - 1 / std::sqrt(1 + y * y + kBetaOmega * y));
  }
  plot.curves = {plain, damped};
  for (const Sample& sample : samples()) {
    sim::BodyModel body = validation::body(sample.mesh, sample.yaml);
    const Modes all = modes(body);
    const Eigen::Index rigid = body.dimension() == 2 ? 3 : 6, last = all.omega.size() - 1;
    Largest error, damped_error;
    Curve ours{sample.model}, ours_damped{sample.model + ", damped"};
    for (const Eigen::Index mode : {rigid, (rigid + last) / 2, last}) {
      for (const double product : products) {
        const double omega = all.omega[mode], h = product / omega;
        body.damping = 0;
        const double lost = 1 - decay(body, all.shape.col(mode), h),
                     expected = 1 - 1 / std::sqrt(1 + product * product);
        error.add(std::abs(lost - expected) / expected);
        body.damping = kBetaOmega / omega;
        const double more = 1 - decay(body, all.shape.col(mode), h);
        const double expected_more = 1 - 1 / std::sqrt(1 + product * product + kBetaOmega * product);
        damped_error.add(std::abs(more - expected_more) / expected_more);
        if (mode == rigid) {
          ours.add(product, lost);
          ours_damped.add(product, more);
        }
      }
    }
    result.figure(sample.model + ": amplitude lost per step, largest relative error", error.value, 0, 3e-4);
    result.figure(sample.model + ": the same with Rayleigh's damping", damped_error.value, 0, 3e-4);
    plot.curves.push_back(std::move(ours));
    plot.curves.push_back(std::move(ours_damped));
  }
  result.plots.push_back(std::move(plot));

  Plot fall{"energy", "Energy of strongly deformed free bodies", "t (s)", "energy over its start"};
  for (const Sample& sample : samples()) {
    Largest rise, drift;
    for (const double beta : {0.0, 0.005}) {
      sim::BodyModel body = validation::body(sample.mesh, sample.yaml);
      body.damping = beta;
      CounterRng rng(9);
      Vector x = flat(sample.mesh.V), v(x.size());
      for (Eigen::Index i = 0; i < x.size(); ++i) {
        x[i] *= 1 + (i % body.dimension() == 0 ? 0.4 : -0.2);
        v[i] = rng.uniform(-1, 1);
      }
      const Vector mass = coordinate_masses(body);
      const auto momentum = [&](const Vector& velocity) {
        return resultant(Vector::Zero(x.size()), mass.cwiseProduct(velocity), body.dimension()).force;
      };
      const Vector before = momentum(v);
      Motion motion(body, x, v, 1.0 / 100);
      double last = energy(body, body.S0, x) + motion.kinetic_energy();
      const double start = last;
      Curve curve{sample.model + (beta > 0 ? ", damped" : "")};
      for (int n = 1; n <= 100; ++n) {
        motion.step(Vector(0));
        const double now = energy(body, body.S0, motion.x()) + motion.kinetic_energy();
        rise.add((now - last) / start);
        last = now;
        if (n <= 40 && n % 2 == 0) curve.add(n / 100.0, now / start);
      }
      drift.add((momentum(motion.v()) - before).norm() / before.norm());
      fall.curves.push_back(std::move(curve));
    }
    result.figure(sample.model + ": largest rise of the energy in a step, over its start", rise.value, 0,
                  1e-14);
    result.figure(sample.model + ": change of the momentum, relative", drift.value, 0, 1e-11);
  }
  result.plots.push_back(std::move(fall));
  return result;
}

}  // namespace vivify::validation
