// Steps of a walker of the plane, counted from the positions of its vertices.
#pragma once

#include <vector>

#include "common/matrix.h"

namespace vivify::testing_support {

// The vertices in the left or right half of the lowest tenth at rest.
struct Foot {
  std::vector<int> vertices;
  double place(const RowMatrixXd& x) const { return x(vertices, 0).mean(); }
  double sole(const RowMatrixXd& x) const { return x(vertices, 1).minCoeff(); }
};

inline Foot foot_of(const RowMatrixXd& rest, bool left) {
  const Eigen::RowVectorXd low = rest.colwise().minCoeff(), high = rest.colwise().maxCoeff();
  Foot foot;
  for (int v = 0; v < rest.rows(); ++v) {
    const Eigen::RowVectorXd share = (rest.row(v) - low).array() / (high - low).array();
    if (share[1] <= 0.1 && (share[0] < 0.5) == left) foot.vertices.push_back(v);
  }
  return foot;
}

// Times that the foot was raised by 1 % of the height and put down at least 5 % further towards `side` (±1).
inline int count_steps(const std::vector<RowMatrixXd>& frames, const Foot& foot, double height, int side) {
  int steps = 0;
  bool raised = false;
  double from = foot.place(frames.front());
  for (const RowMatrixXd& x : frames) {
    if (foot.sole(x) > 0.01 * height) raised = true;
    if (foot.sole(x) > 0.004 * height) continue;
    if (raised) {
      steps += side * (foot.place(x) - from) > 0.05 * height;
      raised = false;
    }
    from = foot.place(x);
  }
  return steps;
}

// Of both feet.
inline int count_steps(const std::vector<RowMatrixXd>& frames, double height, int side) {
  return count_steps(frames, foot_of(frames.front(), true), height, side) +
         count_steps(frames, foot_of(frames.front(), false), height, side);
}

}  // namespace vivify::testing_support
