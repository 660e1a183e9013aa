// Random small steps on which the step methods are compared with Ipopt.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sim/body.h"
#include "sim/solve/step_method.h"
#include "sim/solve/step_problem.h"

namespace vivify::ipopt {

// One step of a little body in mid-motion: turned, bent and stretched at random, thrown and spinning, with
// goals for the velocity of its centre and its spin that are a moderate change of what it does.
struct StepCase {
  std::string model;       // a name of sim/elastic/models.h
  std::string rest_space;  // a name of sim/rest/rest_space.h
  bool closed = false;     // rods only: a ring
  bool ground = false;     // some of its points press against a plane with friction
  bool damped = false;
  std::uint64_t seed = 0;

  std::string name() const;  // of letters, digits and _
};

// Twenty: every model with a cage, examples and all vertices free, two of them closed rods.
const std::vector<StepCase>& step_cases();

struct Step {
  explicit Step(const StepCase& of);
  Step(const Step&) = delete;

  sim::BodyModel body;
  std::vector<sim::Collider> colliders;
  sim::ContactSet contacts;
  sim::Goals goals;
  Eigen::VectorXd x, q;  // the guess: x̃ and the rest shape of the last step
  std::unique_ptr<sim::StepProblem> problem;
  std::unique_ptr<sim::StepWorkspace> workspace;
};

}  // namespace vivify::ipopt
