// Time of the SQP beside that of Ipopt on the random small steps of step_case.h.
//   ipopt_bench [ALTERNATIONS]
// Three comparisons: as the program runs, and asked for the objective within 1e-6 of the optimum with
// Gauss–Newton blocks and with the exact Hessian. Ipopt ends at the first iterate that is as good as our
// result, in the objective and in the equations of motion; it begins at the feasible point that the SQP has
// to find first, and analyses its sparsity before the clock runs. Times are processor time of this thread,
// medians of alternating runs. Last, both are run to the optimum, and their objectives compared.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <vector>

#include "bench/ipopt/ipopt_step.h"
#include "bench/ipopt/step_case.h"
#include "sim/solve/step_method.h"

using namespace vivify;

namespace {

double seconds_of(const std::function<void()>& work) {
  const auto now = [] {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  };
  const double begin = now();
  work();
  return now() - begin;
}

double median(std::vector<double> values) {
  const std::size_t middle = values.size() / 2;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(middle), values.end());
  return values[middle];
}

struct Comparison {
  int our_iterations = 0, their_iterations = 0;
  double ours = 0, theirs = 0;  // s
  double ratio = 0;             // theirs over ours
  double objective = 0;         // ours, J
};

// Where Ipopt begins, and solve_sqp too.
Eigen::VectorXd feasible_start(ipopt::Step& step) {
  return start_feasibly(*step.problem, step.q, step.x, sim::kStartTolerance, *step.workspace).at.x;
}

Comparison compare(ipopt::Step& step, const sim::SolverSettings& solver, int alternations) {
  const sim::StepProblem& problem = *step.problem;
  step.body.solver = solver;
  const Eigen::VectorXd start = feasible_start(step);
  const sim::StepSolution solution = solve_sqp(problem, step.q, step.x, *step.workspace);
  const ipopt::Settings as_good = {.enough_residual = sim::kFinishTolerance,
                                   .enough_objective = solution.objective};
  ipopt::Solver ipopt(problem);
  const ipopt::Solution reference = ipopt.solve(start, step.q, as_good);
  std::vector<double> ours, theirs, ratios;
  for (int i = 0; i < alternations; ++i) {
    ours.push_back(seconds_of([&] { solve_sqp(problem, step.q, step.x, *step.workspace); }));
    theirs.push_back(seconds_of([&] { ipopt.solve(start, step.q, as_good); }));
    ratios.push_back(theirs.back() / ours.back());
  }
  return {solution.iterations, reference.iterations, median(ours),
          median(theirs),      median(ratios),       solution.objective};
}

void print_ratios(const char* of, std::vector<double> ratios) {
  std::sort(ratios.begin(), ratios.end());
  std::printf("Ipopt over ours, %s: median %.1f, least %.1f, most %.1f\n", of, median(ratios), ratios.front(),
              ratios.back());
}

}  // namespace

int main(int argc, char** argv) {
  const int alternations = argc > 1 ? std::max(1, std::atoi(argv[1])) : 11;
  const sim::SolverSettings tight{
      .exact_hessian = true, .max_iterations = 500, .decrement = 1e-14, .small_gain = 0};
  const std::array<const char*, 3> settings = {"as the program runs", "to 1e-6, Gauss-Newton",
                                               "to 1e-6, exact Hessian"};
  std::printf("%-47s", "");
  for (const char* name : settings) std::printf("  | %-44s", name);
  std::printf("  |\n%-38s%4s %4s", "step", "DOFs", "q");
  for (std::size_t k = 0; k < settings.size(); ++k) {
    std::printf("  | %4s %4s %7s %7s %6s %11s", "its", "Ip.", "ms", "Ip. ms", "ratio", "above opt.");
  }
  std::printf("  | at the optimum\n");
  std::array<std::vector<double>, 3> ratios;
  double worst = 0;
  for (const ipopt::StepCase& of : ipopt::step_cases()) {
    ipopt::Step step(of);
    step.body.solver = tight;
    const double optimum = solve_sqp(*step.problem, step.q, step.x, *step.workspace).objective;
    const ipopt::Solution theirs = ipopt::Solver(*step.problem).solve(feasible_start(step), step.q);
    const double difference = std::abs(theirs.objective - optimum) / optimum;
    worst = std::max(worst, difference);

    std::printf("%-38s%4d %4d", of.name().c_str(), step.body.dofs(), static_cast<int>(step.q.size()));
    sim::SolverSettings accurate = tight;
    accurate.decrement = 1e-6 * optimum / (step.body.weight * step.body.height);
    sim::SolverSettings gauss_newton = accurate;
    gauss_newton.exact_hessian = false;
    const std::array<sim::SolverSettings, 3> solvers = {sim::SolverSettings(), gauss_newton, accurate};
    for (std::size_t k = 0; k < solvers.size(); ++k) {
      const Comparison at = compare(step, solvers[k], alternations);
      ratios[k].push_back(at.ratio);
      std::printf("  | %4d %4d %7.2f %7.2f %6.1f %11.1e", at.our_iterations, at.their_iterations,
                  1e3 * at.ours, 1e3 * at.theirs, at.ratio, std::max(0.0, at.objective / optimum - 1));
    }
    std::printf("  | %.0e%s\n", difference, theirs.converged ? "" : " Ipopt failed");
  }
  for (std::size_t k = 0; k < settings.size(); ++k) print_ratios(settings[k], ratios[k]);
  std::printf("Largest relative difference of the objective at the optimum: %.1e\n", worst);
  return 0;
}
