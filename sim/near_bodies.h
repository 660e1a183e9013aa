// Which bodies may touch in a step, and where.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "sim/body.h"
#include "sim/contact/surface_pairs.h"

namespace vivify::sim {

// A body and its number in the world.
struct Member {
  int index;
  Body* body;
};

// The near places of two members (body a may be body b: contact with itself).
struct BodyPairs {
  int a, b;  // numbers in the world, a <= b
  std::vector<SurfacePair> pairs;
};

// Where members are near each other, their surfaces where they were moved to: as far apart as their moves in
// a step (d #V each, m) may bring them together. Bodies that fly side by side are near only if they are
// close. In the order of the numbers (the members' order is ascending); bodies of different dimensions never
// meet. Places that the bodies pass by are left out, or are those where they get to: at seams between bodies
// that lie flush, and, while the moves are `ahead` (else they led to where the surfaces are), where a point
// gets past an edge.
std::vector<BodyPairs> near_bodies(const std::vector<Member>& members,
                                   const std::vector<Eigen::VectorXd>& moves, bool ahead);

// Whether a member is thin: what has no inside cannot be pushed back out.
bool has_thin(const std::vector<Member>& members);

// Numbers (a <= b) of the members that would touch on straight lines from their surfaces by `moves` (d #V
// each) although one of them is thin, among those that `wanted(a, b)` asks for.
std::vector<std::pair<int, int>> crossing_bodies(const std::vector<Member>& members,
                                                 const std::vector<Eigen::VectorXd>& moves,
                                                 const std::function<bool(int, int)>& wanted);

}  // namespace vivify::sim
