// Whether a character did what it was sent to do: got to its place, and if not, what kept it from there; and
// to the end of its script. Read off what happened, for the summary of a run.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "common/matrix.h"
#include "common/value.h"
#include "pipeline/step_table.h"

namespace vivify::pipeline {

struct Arrival {
  Eigen::Vector3d place;             // m
  double missing = 0;                // level distance from the centre of mass at the end, m
  bool arrived = false;              // within 0.2 of the body's width, and not above its head
  std::vector<std::string> reasons;  // why not, in words
};

struct Destination {
  Eigen::Vector3d place;  // m
  int behavior = 0;       // that leads there, from 0
};

// Where the last travel of a body's controller or script ends; nothing when it ends nowhere.
std::optional<Destination> destination(const Value& body);

// `rest` and `last`: the body as placed in the scene and in the last frame (#V by d, m). `gravity` in m/s².
Arrival judge_arrival(const Value& body, const Destination& destination, const StepTable& steps,
                      double gravity, const RowMatrixXd& rest, const RowMatrixXd& last);

// "cup: did not arrive at [2, 0, 1]: 1.20 m short; it fell over at 2.3 s".
std::string describe(const std::string& body, const Arrival& arrival);

// How far a body got in its script.
struct Progression {
  std::string at;                        // "behavior[0].wait until ball.arrived"
  std::vector<std::string> never_began;  // "behavior[1].hop"
};
Progression progression(const Value& body, const StepTable& steps);

// "cup: the clip ended at behavior[0].hop; behavior[1].turn never began".
std::string describe(const std::string& body, const Progression& progression);

}  // namespace vivify::pipeline
