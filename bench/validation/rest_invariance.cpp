#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>

#include "bench/validation/bodies.h"
#include "bench/validation/lattice.h"
#include "bench/validation/problem.h"

namespace vivify::validation {
namespace {

// Energy, forces and stiffness at x for a stacked rest shape X.
struct State {
  double W;
  Vector f;
  Matrix D;
};
State evaluate(const sim::BodyModel& body, const Vector& X, const Vector& x) {
  std::vector<Vector> S(body.elastic.size());
  for (std::size_t f = 0; f < S.size(); ++f) body.elastic[f]->values(sim::Side::rest, X, S[f]);
  sim::SymmetricMatrix D(*body.pattern);
  stiffness(body, S, x, D);
  return {energy(body, S, x), gradient(body, S, x), D * Matrix::Identity(x.size(), x.size())};
}

Matrix random_rotation(int d, CounterRng& rng) {
  Matrix R = Eigen::HouseholderQR<Matrix>(random_vector(d * d, 1, rng).reshaped(d, d)).householderQ();
  if (R.determinant() < 0) R.col(0) *= -1;
  return R;
}

// Points begin … end − 1 of X turned and moved together.
void move(Vector& X, int d, int begin, int end, const Matrix& R, const Vector& b) {
  for (int i = begin; i < end; ++i) X.segment(d * i, d) = R * X.segment(d * i, d).eval() + b;
}

}  // namespace

Result rest_invariance(Effort effort) {
  Result result;
  result.title = "Invariances of the rest shape";
  result.text =
      "A rigid motion of a compatible rest shape X, and a random rigid motion of each element of an "
      "incompatible one on "
      "its own (Section 5.1), change neither the energy nor the forces nor the stiffness of any deformed "
      "body. Random "
      "states of every model; largest relative changes.";
  const int trials = effort == Effort::full ? 20 : 5;
  Plot plot{"rest_invariance",
            "Change under rigid motions of the rest shape",
            "trial",
            "largest relative change",
            false,
            true};
  Curve compatible{"whole body"}, per_element{"each element on its own"},
      tolerance{"tolerance", {}, {}, true};
  std::vector<Largest> whole_of(static_cast<std::size_t>(trials)),
      element_of(static_cast<std::size_t>(trials));
  for (const Sample& sample : samples()) {
    const int d = sample.mesh.dimension();
    CounterRng rng(31);
    Largest whole, element;
    for (const bool incompatible : {false, true}) {
      const sim::BodyModel body = sample_body(sample, incompatible ? "examples" : "full");
      const sim::RestPoints points =
          build_model(sample.mesh, incompatible ? sim::RestLayout::incompatible : sim::RestLayout::compatible,
                      settings(sim::model_schema(), sample.yaml))
              .rest;
      const Vector X0 = stack(sample.mesh.V, points);
      for (int trial = 0; trial < trials; ++trial) {
        const Vector x = flat(sample.mesh.V) + random_vector(body.dofs(), 0.02, rng);
        const Vector X = X0 + random_vector(X0.size(), 0.01, rng);
        Vector moved = X;
        if (incompatible) {
          for (std::size_t e = 0; e + 1 < points.element_begin.size(); ++e) {
            move(moved, d, points.element_begin[e], points.element_begin[e + 1], random_rotation(d, rng),
                 random_vector(d, 1, rng));
          }
        } else {
          move(moved, d, 0, points.size(), random_rotation(d, rng), random_vector(d, 1, rng));
        }
        const State before = evaluate(body, X, x), after = evaluate(body, moved, x);
        const std::size_t t = static_cast<std::size_t>(trial);
        for (const double change :
             {std::abs(after.W - before.W) / before.W, (after.f - before.f).norm() / before.f.norm(),
              (after.D - before.D).norm() / before.D.norm()}) {
          (incompatible ? element : whole).add(change);
          (incompatible ? element_of : whole_of)[t].add(change);
        }
      }
    }
    result.figure(sample.model + ": rigid motion of the rest shape", whole.value, 0, 1e-12);
    result.figure(sample.model + ": rigid motion of each rest element", element.value, 0, 1e-12);
  }
  for (std::size_t t = 0; t < whole_of.size(); ++t) {
    compatible.add(static_cast<double>(t + 1), whole_of[t].value);
    per_element.add(static_cast<double>(t + 1), element_of[t].value);
    tolerance.add(static_cast<double>(t + 1), 1e-12);
  }
  plot.curves = {compatible, per_element, tolerance};
  result.plots.push_back(std::move(plot));
  return result;
}

}  // namespace vivify::validation
