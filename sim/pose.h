// The static solver with which example poses are made (Section 7 of Coros et al. 2012): a few handles take
// hold of parts of a body and are pinned, moved, turned or scaled, and the rest of the body finds its
// equilibrium.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "common/mesh.h"
#include "common/value.h"
#include "sim/region.h"

namespace vivify::sim {

// Takes hold of some vertices and maps them by X ↦ about + R diag(scale) (X − about) + move. Without any of
// these it is a pin. Bodies of the plane turn about z.
struct PoseHandle {
  Region region;
  Eigen::Vector3d move = Eigen::Vector3d::Zero();   // m
  Eigen::Vector3d axis = Eigen::Vector3d::UnitY();  // of the turn; need not have unit length
  double angle = 0;                                 // rad; more than a turn winds the body up
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();  // along x, y, z, before the turn
  std::optional<Eigen::Vector3d> about;  // shares of the bounding box; else the middle of the vertices
};

struct PoseSolution {
  RowMatrixXd V;                // #V by d
  std::vector<int> held;        // vertices held by each handle
  int increments = 0;           // solved on the way
  int iterations = 0;           // of Newton's method, in all
  double energy = 0;            // J, elastic and gravity
  double residual = 0;          // largest force on a free vertex, N
  double smallest_element = 1;  // smallest size of an element over that at rest
};

// The pose of `rest` with the elastic model `model` (resolved with model_schema) under `gravity` (m/s²). The
// handles travel in increments that are halved where the solver or an element gives in. Throws Error(usage)
// for handles that hold nothing, hold a vertex twice or turn about no axis; Error(geometry) for a mesh that
// the model cannot take; and Error(numerical) that says how far the handles came when they cannot reach their
// end.
PoseSolution solve_pose(const SimMesh& rest, const Value& model, std::span<const PoseHandle> handles,
                        const Eigen::Vector3d& gravity = Eigen::Vector3d::Zero());

}  // namespace vivify::sim
