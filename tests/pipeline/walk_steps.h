// Steps of a walker of the plane, counted from the positions of its vertices.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "common/matrix.h"

namespace vivify::testing_support {

// The vertices in the lowest tenth at rest, to the left or the right of the widest gap between them.
struct Foot {
  std::vector<int> vertices;
  double place(const RowMatrixXd& x) const { return x(vertices, 0).mean(); }
  double sole(const RowMatrixXd& x) const { return x(vertices, 1).minCoeff(); }
};

inline Foot foot_of(const RowMatrixXd& rest, bool left) {
  const double low = rest.col(1).minCoeff(), high = rest.col(1).maxCoeff();
  std::vector<int> vertices;
  for (int v = 0; v < rest.rows(); ++v) {
    if (rest(v, 1) <= low + 0.1 * (high - low)) vertices.push_back(v);
  }
  std::sort(vertices.begin(), vertices.end(), [&](int a, int b) { return rest(a, 0) < rest(b, 0); });
  std::size_t split = 1;
  const auto gap = [&](std::size_t i) { return rest(vertices[i], 0) - rest(vertices[i - 1], 0); };
  for (std::size_t i = 2; i < vertices.size(); ++i) {
    if (gap(i) > gap(split)) split = i;
  }
  const auto middle = vertices.begin() + static_cast<std::ptrdiff_t>(split);
  return {left ? std::vector<int>(vertices.begin(), middle) : std::vector<int>(middle, vertices.end())};
}

// Times that the foot came to rest at least 5 % of the height further towards `side` (±1), having been raised
// by 1 % of the height above either place. It rests where it moves by less than 0.4 % from frame to frame.
inline int count_steps(const std::vector<RowMatrixXd>& frames, const Foot& foot, double height, int side) {
  int steps = 0;
  double place = foot.place(frames.front()), sole = foot.sole(frames.front());
  double from = place, ground = sole, highest = sole;
  for (const RowMatrixXd& x : frames) {
    const double moved = std::max(std::abs(foot.place(x) - place), std::abs(foot.sole(x) - sole));
    place = foot.place(x);
    sole = foot.sole(x);
    highest = std::max(highest, sole);
    if (moved > 0.004 * height) continue;
    const bool raised = highest > std::max(ground, sole) + 0.01 * height;
    steps += raised && side * (place - from) > 0.05 * height;
    from = place;
    ground = highest = sole;
  }
  return steps;
}

// Of both feet.
inline int count_steps(const std::vector<RowMatrixXd>& frames, double height, int side) {
  return count_steps(frames, foot_of(frames.front(), true), height, side) +
         count_steps(frames, foot_of(frames.front(), false), height, side);
}

}  // namespace vivify::testing_support
