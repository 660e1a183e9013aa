#include <cmath>
#include <functional>

#include "bench/validation/bodies.h"
#include "bench/validation/problem.h"

namespace vivify::validation {
namespace {

// A function of one number, and its exact derivative at 0.
struct Rung {
  std::string name;
  std::function<Vector(double)> function;
  Vector derivative;
};

// Every derivative of the step along random directions, each against the one before it.
std::vector<Rung> ladder(const StepState& state, CounterRng& rng) {
  const sim::StepProblem& problem = *state.problem;
  const Vector lambda = random_vector(state.x.size(), 1, rng), dx = random_vector(state.x.size(), 1, rng),
               dq = random_vector(state.q.size(), 1, rng);
  const auto at = [&state, dx](double t) { return state.problem->deformed_point(state.x + t * dx); };
  const auto rest = [&state, dq](double t) { return state.problem->rest_point(state.q + t * dq, true); };
  const auto D_lambda = [&state, lambda](const sim::DeformedPoint& x, const sim::RestPoint& q) {
    sim::SymmetricMatrix D(*state.body.pattern);
    state.problem->stiffness(x, q, D);
    return Vector(D * lambda);
  };
  sim::SymmetricMatrix D(*state.body.pattern), A(*state.body.pattern);
  problem.stiffness(at(0), rest(0), D);
  problem.block_A(at(0), rest(0), lambda, A);
  return {
      {"force", [&, at, rest](double t) { return Vector::Constant(1, problem.potential(at(t), rest(0))); },
       Vector::Constant(1, problem.residual(at(0), rest(0)).dot(dx))},
      {"D", [&, at, rest](double t) { return problem.residual(at(t), rest(0)); }, D * dx},
      {"E", [&, at, rest](double t) { return problem.residual(at(0), rest(t)); },
       problem.multiply_E(at(0), rest(0), dq)},
      {"A", [=](double t) { return D_lambda(at(t), rest(0)); }, A * dx},
      {"B", [=](double t) { return D_lambda(at(0), rest(t)); },
       problem.block_B(at(0), rest(0), lambda).transpose() * dq},
      {"C",
       [&, at, rest, lambda](double t) {
         const sim::RestPoint q = rest(t);
         return Vector(problem.regularizer_gradient(q) + problem.multiply_Et(at(0), q, lambda));
       },
       problem.block_C(at(0), rest(0), lambda) * dq},
  };
}

}  // namespace

Result derivatives(Effort effort) {
  Result result;
  result.title = "Derivatives";
  result.text =
      "Central differences of every function of a step along random directions, over the step ε of the "
      "difference (m, "
      "or parameters): the force against the energy, D = ∂c/∂x and E = ∂c/∂q against the force, and the "
      "blocks A, B, C of "
      "equation (13) against D and E with a random multiplier. Every model with the rest spaces `full`, "
      "`cage` and "
      "`examples`, in a random deformed state; the plot has the largest relative error over all of them. The "
      "error must "
      "fall with ε² until rounding takes over. Some functions are quadratic in the rest shape, where central "
      "differences are exact; the order is that between ε = 1e-3 and 5e-4 where the error is above 1e-7.";
  const int kRungs = 6;
  const int per_decade = effort == Effort::full ? 4 : 2;
  std::vector<double> steps;
  for (int i = 0; i <= 7 * per_decade; ++i)
    steps.push_back(0.01 * std::pow(10, -static_cast<double>(i) / per_decade));
  std::vector<Curve> largest(kRungs);
  std::vector<Largest> worst(kRungs), order_error(kRungs);
  Table table{"Smallest relative error over ε.", {"model", "rest space", "force", "D", "E", "A", "B", "C"}};
  for (const Sample& sample : samples()) {
    for (const std::string space : {"full", "cage", "examples"}) {
      const StepState state(sample, space, 21);
      CounterRng rng(22);
      std::vector<std::string> row = {sample.model, space};
      int r = 0;
      for (const Rung& rung : ladder(state, rng)) {
        const std::size_t k = static_cast<std::size_t>(r++);
        const auto error = [&](double eps) {
          return ((rung.function(eps) - rung.function(-eps)) / (2 * eps) - rung.derivative).norm() /
                 rung.derivative.norm();
        };
        double smallest = INFINITY;
        largest[k].name = rung.name;
        largest[k].x = steps;
        largest[k].y.resize(steps.size(), 0);
        for (std::size_t i = 0; i < steps.size(); ++i) {
          const double value = error(steps[i]);
          smallest = std::min(smallest, value);
          largest[k].y[i] = std::max(largest[k].y[i], value);
        }
        row.push_back(short_number(smallest));
        worst[k].add(smallest);
        if (error(1e-3) > 1e-7) {
          order_error[k].add(std::abs(std::log2(error(1e-3) / error(5e-4)) - 2));
        }
      }
      table.rows.push_back(std::move(row));
    }
  }
  Plot plot{"derivatives", "Largest error of central differences over all models and rest spaces",
            "ε",           "relative error",
            true,          true};
  for (std::size_t k = 0; k < largest.size(); ++k) {
    result.figure(largest[k].name + ": smallest relative error, largest of all", worst[k].value, 0,
                  k < 3 ? 1e-8 : 1e-7);
    result.figure(largest[k].name + ": departure from second order", order_error[k].value, 0, 0.05);
    plot.curves.push_back(largest[k]);
  }
  Curve second{"second order", {}, {}, true};
  for (const double eps : {1e-6, 1e-2}) second.add(eps, 1e3 * eps * eps);
  plot.curves.push_back(std::move(second));
  result.plots.push_back(std::move(plot));
  result.tables.push_back(std::move(table));
  return result;
}

}  // namespace vivify::validation
