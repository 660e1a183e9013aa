// Passive bodies that touch colliders and one another: what the problems of contact share.
#pragma once

#include <vector>

#include "bench/validation/bodies.h"
#include "bench/validation/problem.h"
#include "sim/world.h"

namespace vivify::validation {

inline constexpr double kGravity = 9.81;  // m/s², downwards

// A low body of every model, half a metre long, lying about x = z = 0 with its lowest points at y = 0. `keys`
// are further keys of the model.
std::vector<Sample> blocks(const std::string& keys = "");

// A passive body that touches with every vertex of its boundary. `contact` are settings (YAML).
sim::BodyInput standing_body(const SimMesh& mesh, const std::string& model, const std::string& name = "body",
                             const std::string& contact = "{}");

// The plane through the origin that falls by `degrees` towards +x.
std::vector<sim::Collider> inclined_plane(double friction, double degrees = 0);
// The mesh turned likewise.
SimMesh inclined(SimMesh mesh, double degrees);

SimMesh moved(SimMesh mesh, const Eigen::Vector3d& by);

// Of body b at the end of the last step.
Eigen::Vector3d centre(const sim::World& world, int b = 0);
Eigen::Vector3d velocity(const sim::World& world, int b = 0);
double mass(const sim::World& world, int b = 0);
// The record of body b in the last step.
const sim::StepRecord& record(const sim::World& world, int b = 0);

// How well bodies stand.
struct Standing {
  double drift = 0;        // largest motion of a centre once they have settled, m
  double penetration = 0;  // deepest, m
  double start = 0;        // height of the centre of body `key` at the start, m
  double sunk = 0;         // that it lost, m
  Curve height;            // that it has, m over s
};
// Steps the world for six seconds, of which the first is for settling.
Standing watch_standing(sim::World& world, double h, int key);

}  // namespace vivify::validation
