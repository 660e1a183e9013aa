// Time of the SQP beside that of Ipopt on the random small steps of step_case.h.
//   ipopt_bench [ALTERNATIONS]
// Two comparisons, as the program runs and with the objective within 1e-6 of the optimum. In both Ipopt ends
// at the first iterate that is as good as our result, in the objective and in the equations of motion; it
// begins at the feasible point that the SQP has to find first, and analyses its sparsity before the clock
// runs. Times are processor time of this thread, medians of alternating runs. Last, both are run to the
// optimum, and their objectives compared.
#include <algorithm>
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
  double inside = 0;            // share of theirs spent in Ipopt, not in the functions of the problem
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
  std::vector<double> ours, theirs, ratios, inside;
  for (int i = 0; i < alternations; ++i) {
    ours.push_back(seconds_of([&] { solve_sqp(problem, step.q, step.x, *step.workspace); }));
    ipopt::Solution again;
    theirs.push_back(seconds_of([&] { again = ipopt.solve(start, step.q, as_good); }));
    ratios.push_back(theirs.back() / ours.back());
    inside.push_back(1 - again.evaluation_seconds / theirs.back());
  }
  return {solution.iterations, reference.iterations, median(ours),
          median(theirs),      median(ratios),       median(inside)};
}

void print(const Comparison& at) {
  std::printf("  | %4d %4d %7.2f %7.2f %6.1f %4.0f %%", at.our_iterations, at.their_iterations, 1e3 * at.ours,
              1e3 * at.theirs, at.ratio, 100 * at.inside);
}

void print_ratios(const char* of, std::vector<double> ratios) {
  std::sort(ratios.begin(), ratios.end());
  std::printf("Ipopt over ours, %s: median %.1f, least %.1f, most %.1f\n", of, median(ratios), ratios.front(),
              ratios.back());
}

}  // namespace

int main(int argc, char** argv) {
  const int alternations = argc > 1 ? std::max(1, std::atoi(argv[1])) : 11;
  const sim::SolverSettings usual;
  sim::SolverSettings tight{
      .exact_hessian = true, .max_iterations = 500, .decrement = 1e-14, .small_gain = 0};
  std::printf("%38s%9s  | %-40s  | %-40s  |\n", "", "", "as the program runs",
              "objective to 1e-6, exact Hessian");
  const char* const columns = "ours  its    ours  its ms  ratio its own";
  std::printf("%-38s%4s %4s  | %-40s  | %-40s  | at the optimum\n", "step", "DOFs", "q", columns, columns);
  std::vector<double> usual_ratios, accurate_ratios;
  double worst = 0;
  for (const ipopt::StepCase& of : ipopt::step_cases()) {
    ipopt::Step step(of);
    step.body.solver = tight;
    const double ours = solve_sqp(*step.problem, step.q, step.x, *step.workspace).objective;
    const ipopt::Solution theirs = ipopt::Solver(*step.problem).solve(feasible_start(step), step.q);
    const double difference = std::abs(theirs.objective - ours) / ours;
    worst = std::max(worst, difference);

    const Comparison as_usual = compare(step, usual, alternations);
    sim::SolverSettings accurate = tight;
    accurate.decrement = 1e-6 * ours / (step.body.weight * step.body.height);
    const Comparison accurately = compare(step, accurate, alternations);
    usual_ratios.push_back(as_usual.ratio);
    accurate_ratios.push_back(accurately.ratio);
    std::printf("%-38s%4d %4d", of.name().c_str(), step.body.dofs(), static_cast<int>(step.q.size()));
    print(as_usual);
    print(accurately);
    std::printf("  | %.0e%s\n", difference, theirs.converged ? "" : " Ipopt failed");
  }
  print_ratios("as the program runs", usual_ratios);
  print_ratios("objective to 1e-6", accurate_ratios);
  std::printf("Largest relative difference of the objective at the optimum: %.1e\n", worst);
  return 0;
}
